// SPDX-License-Identifier: Apache-2.0
#include "server/store/journal_group.h"

#include <sqlite3.h>

#include <algorithm>
#include <bit>
#include <map>
#include <new>
#include <span>
#include <utility>

#include "kernel/kernel_version.h"
#include "server/store/batch_insert.h"
#include "server/store/record_rows.h"

namespace kerf {
namespace {

SqlResult<void> run(SqlStatement& statement) {
  if (auto row = statement.step(); !row) return std::unexpected(row.error());
  return {};
}

/// Treats a lack of memory during a commit like a full disk: the commit is retried.
template <typename Commit>
SqlResult<void> with_memory(Commit commit) {
  try {
    return commit();
  } catch (const std::bad_alloc&) {
    return std::unexpected(SqlError{SQLITE_NOMEM, "there is not enough memory"});
  }
}

SqlResult<void> insert_participant(SqlStatement& statement, const JournalParticipant& participant) {
  statement.bind(1, std::int64_t{participant.participant});
  statement.bind(2, participant.name);
  statement.bind(3, participant.color);
  statement.bind(4, participant.kind);
  return run(statement);
}

SqlResult<void> insert_agent(SqlStatement& statement, const JournalParticipant& participant) {
  statement.bind(1, std::int64_t{participant.participant});
  statement.bind(2, std::span<const std::byte>(*participant.token));
  statement.bind(3,
                 std::int64_t{progress_checksum(participant.participant, 0, *participant.token)});
  return run(statement);
}

SqlResult<void> insert_hash(SqlStatement& statement, const StateHash& state) {
  statement.bind(1, static_cast<std::int64_t>(state.sequence));
  statement.bind(2, std::bit_cast<std::int64_t>(state.hash));
  return run(statement);
}

SqlResult<void> insert_version(SqlStatement& statement, std::uint64_t sequence) {
  statement.bind(1, static_cast<std::int64_t>(sequence));
  statement.bind(2, kKernelVersion);
  return run(statement);
}

}  // namespace

JournalGroups::JournalGroups(SqlDatabase database, Inserts inserts, std::int64_t last_attachment)
    : last_attachment_(last_attachment),
      database_(std::move(database)),
      inserts_(std::move(inserts)) {}

SqlResult<JournalGroups> JournalGroups::prepare(SqlDatabase database) {
  auto batch = prepare_batch_insert(database);
  if (!batch) return std::unexpected(batch.error());
  auto participant = database.prepare("INSERT OR REPLACE INTO participants VALUES(?,?,?,?)");
  if (!participant) return std::unexpected(participant.error());
  auto hash = database.prepare("INSERT OR REPLACE INTO state_hashes VALUES(?,?)");
  if (!hash) return std::unexpected(hash.error());
  auto version = database.prepare("INSERT OR REPLACE INTO kernel_versions VALUES(?,?)");
  if (!version) return std::unexpected(version.error());
  // Keep the row of an agent that has resumed.
  auto agent = database.prepare("INSERT OR IGNORE INTO agents VALUES(?,?,0,?)");
  if (!agent) return std::unexpected(agent.error());
  auto progress = database.prepare("UPDATE agents SET agent_sequence=?,crc=? WHERE participant=?");
  if (!progress) return std::unexpected(progress.error());
  auto token = database.prepare("SELECT token FROM agents WHERE participant=?");
  if (!token) return std::unexpected(token.error());
  auto removal = database.prepare("DELETE FROM agents WHERE participant=?");
  if (!removal) return std::unexpected(removal.error());
  const auto last = last_attachment(database);
  if (!last) return std::unexpected(last.error());
  return JournalGroups(
      std::move(database),
      {*std::move(batch), *std::move(participant), *std::move(hash), *std::move(version),
       *std::move(agent), *std::move(progress), *std::move(token), *std::move(removal)},
      *last);
}

JournalGroups::Batch JournalGroups::encode(const std::vector<Pending>& group) {
  std::vector<BatchRecord> records;
  BatchHead head;
  for (const Pending& item : group) {
    const auto* command = std::get_if<PendingCommand>(&item);
    if (command == nullptr) continue;
    if (records.empty()) head = {command->sequence, 0, command->wall_ms, 0};
    head.span_ms = std::clamp(command->wall_ms - head.wall_ms, std::int64_t{0}, kSpanMaxMs);
    records.push_back({command->participant, command->command, command->note.begins_stroke});
  }
  head.count = records.size();
  if (records.empty()) return {};
  return {head, encoder_.encode(records)};
}

SqlResult<void> JournalGroups::insert_batch() {
  return kerf::insert_batch(inserts_.batch, batch_.head, batch_.bytes);
}

SqlResult<void> JournalGroups::insert(const Pending& pending) {
  if (std::holds_alternative<PendingCommand>(pending)) return {};  // written with the batch
  if (const auto* participant = std::get_if<JournalParticipant>(&pending)) {
    if (auto ok = insert_participant(inserts_.participant, *participant); !ok) return ok;
    if (participant->is_removed) {
      inserts_.removal.bind(1, std::int64_t{participant->participant});
      return run(inserts_.removal);
    }
    return participant->token ? insert_agent(inserts_.agent, *participant) : SqlResult<void>{};
  }
  if (const auto* recarved = std::get_if<RecarvedHash>(&pending)) {
    if (auto ok = insert_version(inserts_.version, recarved->state.sequence); !ok) return ok;
    return insert_hash(inserts_.hash, recarved->state);
  }
  if (const auto* change = std::get_if<ListChange>(&pending)) {
    return store_list_change(database_, *change);
  }
  if (const auto* change = std::get_if<AttachmentChange>(&pending)) {
    return store_attachment(database_, *change, ++last_attachment_);
  }
  return insert_hash(inserts_.hash, std::get<StateHash>(pending));
}

/// Stores each agent's newest sample number in the transaction of its record.
SqlResult<void> JournalGroups::note_progress(const std::vector<Pending>& group) {
  std::map<ParticipantId, std::uint64_t> newest;
  for (const Pending& item : group) {
    const auto* command = std::get_if<PendingCommand>(&item);
    if (command != nullptr && command->note.agent_sequence != 0) {
      newest[command->participant] = command->note.agent_sequence;
    }
  }
  for (const auto& [participant, sequence] : newest) {
    SqlStatement& token = inserts_.token;
    token.bind(1, std::int64_t{participant});
    const auto row = token.step();
    if (!row) return std::unexpected(row.error());
    if (!*row) continue;  // the agent may not resume
    const auto checksum = progress_checksum(participant, sequence, token.blob(0));
    if (const auto end = token.step(); !end) return std::unexpected(end.error());
    inserts_.progress.bind(1, static_cast<std::int64_t>(sequence));
    inserts_.progress.bind(2, std::int64_t{checksum});
    inserts_.progress.bind(3, std::int64_t{participant});
    if (auto ok = run(inserts_.progress); !ok) return ok;
  }
  return {};
}

/// Stores the line of each program's newest motion in the transaction of its record.
SqlResult<void> JournalGroups::note_lines(const std::vector<Pending>& group) {
  std::map<ParticipantId, std::uint32_t> newest;
  for (const Pending& item : group) {
    const auto* command = std::get_if<PendingCommand>(&item);
    if (command != nullptr && command->note.program_line != 0) {
      newest[command->participant] = command->note.program_line;
    }
  }
  if (newest.empty()) return {};
  auto insert = database_.prepare("INSERT OR REPLACE INTO program_lines VALUES(?,?)");
  if (!insert) return std::unexpected(insert.error());
  for (const auto& [participant, line] : newest) {
    insert->bind(1, std::int64_t{participant});
    insert->bind(2, std::int64_t{line});
    if (auto ok = run(*insert); !ok) return ok;
  }
  return {};
}

SqlResult<void> JournalGroups::insert_all(const std::vector<Pending>& group, std::uint64_t stored) {
  if (batch_.head.count > 0 && batch_.head.first > stored) {
    if (auto ok = insert_batch(); !ok) return ok;
  }
  for (const Pending& item : group) {
    if (auto ok = insert(item); !ok) return ok;
  }
  if (auto ok = note_progress(group); !ok) return ok;
  return note_lines(group);
}

SqlResult<void> JournalGroups::commit_after(const std::vector<Pending>& group,
                                            std::uint64_t stored) {
  if (auto ok = database_.execute("BEGIN IMMEDIATE"); !ok) return ok;
  SqlResult<void> outcome = with_memory([&] { return insert_all(group, stored); });
  if (outcome) outcome = database_.execute("COMMIT");
  // No effect if SQLite has already rolled back.
  if (!outcome) (void)database_.execute("ROLLBACK");
  return outcome;
}

/// Encodes the commands once. An encoder that failed midway is reset, so its next batch restarts.
SqlResult<void> JournalGroups::encode_once(const std::vector<Pending>& group) {
  if (is_encoded_) return {};
  auto encoded = with_memory([&]() -> SqlResult<void> {
    batch_ = encode(group);
    return {};
  });
  is_encoded_ = encoded.has_value();
  if (!encoded) encoder_ = BatchEncoder();
  return encoded;
}

SqlResult<void> JournalGroups::commit(const std::vector<Pending>& group) {
  is_encoded_ = false;
  if (auto ok = encode_once(group); !ok) return ok;
  return commit_after(group, 0);
}

SqlResult<void> JournalGroups::commit_again(const std::vector<Pending>& group) {
  if (auto ok = encode_once(group); !ok) return ok;
  const auto stored = last_record(database_);
  if (!stored) return std::unexpected(stored.error());
  return commit_after(group, *stored);
}

}  // namespace kerf
