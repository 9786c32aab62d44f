# SPDX-License-Identifier: Apache-2.0
"""The faults that tests/sim must find: each is one place of the server's sources, changed. A text
must occur in its file once: where the source has changed, the mutation is written again."""
from typing import NamedTuple


class Mutation(NamedTuple):
    name: str
    file: str
    text: str
    mutated: str


MUTATIONS = [
    Mutation("nothing is synchronized",
             "server/store/journal_file.cpp",
             'const std::string setup = "PRAGMA synchronous=FULL; UPDATE',
             'const std::string setup = "PRAGMA synchronous=OFF; UPDATE'),
    Mutation("samples are durable before the commit",
             "server/store/journal_writer.cpp",
             "JournalWriter::durable_sequence() const { return impl_->durable_sequence.load(); }",
             "JournalWriter::durable_sequence() const { return last_sequence(); }"),
    Mutation("a commit that has failed is not tried again",
             "server/store/journal_writer.cpp",
             "      if (outcome) {\n        committed += group.size();",
             "      if (true) {\n        committed += group.size();"),
    Mutation("a lease is renewed on the wall clock",
             "server/cluster/own_leases.cpp",
             "  held->second.fence->extend(sent + lease.time.writes_ns);",
             "  held->second.fence->extend(std::chrono::system_clock::now().time_since_epoch().count());"),
    Mutation("the journal does not ask for the lease",
             "server/store/journal_writer.cpp",
             "    if (!closed) return pause();",
             "    if (!closed) return disk_pause();"),
    Mutation("a lease is taken whatever it is now",
             "server/cluster/own_leases.cpp",
             "    return std::unexpected(read_newest(session, revision));\n",
             "    return take(session, lease, read_newest(session, revision).stored->revision);\n"),
    Mutation("a server does not learn that NATS has lost a lease",
             "server/cluster/cluster_threads.cpp",
             "  table.correct(id, *error.stored, Clock::boot_ns());\n",
             ""),
    Mutation("a sample that is sent again is cut again",
             "server/session/carving.cpp",
             "  if (sample.agent_sequence <= state.last_sequence) {  // a resent sample",
             "  if (sample.agent_sequence <= state.last_sequence && !state.has_resumed) {"),
    Mutation("a server says that it has a sample more than it has",
             "server/session/participants.cpp",
             "    admission.agent_sequence = known.last_sequence;",
             "    admission.agent_sequence = known.last_sequence + 1;"),
    Mutation("an undo is not in the journal",
             "server/session/stroke_changes.cpp",
             "  if (auto ok = journal_.append(request.author, changes); !ok) return ok.error();",
             "  if (auto ok = journal_.check_space_for_programs(); !ok) return ok.error();"),
    Mutation("motions during an undo are not cut again",
             "server/session/stroke_changes.cpp",
             "      carving_.begin_collecting();\n",
             ""),
    Mutation("an undo of several strokes is several commits",
             "server/store/journal_writer.cpp",
             "  return impl_->append(participant, commands, {});",
             "  std::expected<std::uint64_t, JournalError> last = 0;\n"
             "  for (std::size_t i = 0; i < commands.size() && last; ++i) {\n"
             "    last = impl_->append(participant, commands.subspan(i, 1), {});\n"
             "    if (i == 0) (void)flush();\n"
             "  }\n"
             "  return last;"),
    Mutation("a pin is answered before it is durable",
             "server/pins/pin_routes.cpp",
             "  if (auto failure = flush_failure(session)) return *std::move(failure);\n"
             "  return json_response(201, pin_json(*set));",
             "  return json_response(201, pin_json(*set));"),
    Mutation("a follower leaves out a record",
             "server/cluster/copy_follower.cpp",
             "  const RecordRange range{followed.applied + 1, last};",
             "  const RecordRange range{followed.applied + 2, last};"),
    Mutation("a copy is said to be further than it is",
             "server/cluster/journal_replica.cpp",
             "    if (!send()) return false;\n",
             "    state_.record = changes_.position().record;\n    show();\n    if (!send()) return false;\n"),
    Mutation("the meshes get a change of the block late",
             "server/socket/viewer_hub.cpp",
             "        self->side_->feed->note_change(std::move(snapshot), frame.changed, frame.motions);\n",
             "        auto note = [side = self->side_, snapshot = std::move(snapshot), changed = frame.changed,\n"
             "                     motions = frame.motions]() mutable {\n"
             "          side->feed->note_change(std::move(snapshot), changed, motions);\n"
             "        };\n"
             "        with_job ? self->context_.meshing.post(std::move(note)) : note();\n"),
    Mutation("guests may set pins",
             "server/rights/rights.cpp",
             'Row{Action::kPlacePins, "place_pins", "...xxx",',
             'Row{Action::kPlacePins, "place_pins", ".x.xxx",'),
    Mutation("the checksums of records are not compared",
             "server/store/batch_rows.cpp",
             "  if (row.crc != std::int64_t{batch_checksum(head, row.bytes)}) {",
             "  if (row.crc == -1 && row.crc != std::int64_t{batch_checksum(head, row.bytes)}) {"),
    Mutation("a lack of memory is a fault of the server",
             "server/http/responses.cpp",
             "  if (dynamic_cast<const std::bad_alloc*>(&error) != nullptr) return out_of_memory();\n",
             ""),
    Mutation("a failing disk is a damaged journal",
             "server/session/session_registry.cpp",
             "  return {is_permanent ? RegistryErrorCode::kJournal : RegistryErrorCode::kDiskFails,",
             "  return {is_permanent || true ? RegistryErrorCode::kJournal : RegistryErrorCode::kDiskFails,"),
]
