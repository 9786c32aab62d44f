// SPDX-License-Identifier: Apache-2.0
#include "server/store/journal_group.h"

#include <bit>
#include <span>
#include <utility>

#include "kernel/kernel_version.h"

namespace kerf {
namespace {

SqlResult<void> run(SqlStatement& statement) {
  if (auto row = statement.step(); !row) return std::unexpected(row.error());
  return {};
}

SqlResult<void> insert_command(SqlStatement& statement, const PendingCommand& command) {
  statement.bind(1, static_cast<std::int64_t>(command.sequence));
  statement.bind(2, std::int64_t{command.participant});
  statement.bind(3, std::span<const std::byte>(command.bytes));
  statement.bind(
      4, std::int64_t{record_checksum(command.sequence, command.participant, command.bytes)});
  return run(statement);
}

SqlResult<void> insert_participant(SqlStatement& statement, const JournalParticipant& participant) {
  statement.bind(1, std::int64_t{participant.participant});
  statement.bind(2, participant.name);
  statement.bind(3, participant.color);
  statement.bind(4, participant.kind);
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

JournalGroups::JournalGroups(SqlDatabase database, Inserts inserts)
    : database_(std::move(database)), inserts_(std::move(inserts)) {}

SqlResult<JournalGroups> JournalGroups::prepare(SqlDatabase database) {
  auto command = database.prepare("INSERT INTO commands VALUES(?,?,?,?)");
  if (!command) return std::unexpected(command.error());
  auto participant = database.prepare("INSERT OR REPLACE INTO participants VALUES(?,?,?,?)");
  if (!participant) return std::unexpected(participant.error());
  auto hash = database.prepare("INSERT OR REPLACE INTO state_hashes VALUES(?,?)");
  if (!hash) return std::unexpected(hash.error());
  auto version = database.prepare("INSERT OR REPLACE INTO kernel_versions VALUES(?,?)");
  if (!version) return std::unexpected(version.error());
  return JournalGroups(std::move(database), {*std::move(command), *std::move(participant),
                                             *std::move(hash), *std::move(version)});
}

SqlResult<void> JournalGroups::insert(const Pending& pending, std::uint64_t stored) {
  if (const auto* command = std::get_if<PendingCommand>(&pending)) {
    if (command->sequence <= stored) return {};
    return insert_command(inserts_.command, *command);
  }
  if (const auto* participant = std::get_if<JournalParticipant>(&pending)) {
    return insert_participant(inserts_.participant, *participant);
  }
  if (const auto* recarved = std::get_if<RecarvedHash>(&pending)) {
    if (auto ok = insert_version(inserts_.version, recarved->state.sequence); !ok) return ok;
    return insert_hash(inserts_.hash, recarved->state);
  }
  return insert_hash(inserts_.hash, std::get<StateHash>(pending));
}

SqlResult<void> JournalGroups::commit_after(const std::vector<Pending>& group,
                                            std::uint64_t stored) {
  if (auto ok = database_.execute("BEGIN IMMEDIATE"); !ok) return ok;
  SqlResult<void> outcome;
  for (const Pending& item : group) {
    outcome = insert(item, stored);
    if (!outcome) break;
  }
  if (outcome) outcome = database_.execute("COMMIT");
  // SQLite may have rolled back by itself; then this fails without an effect.
  if (!outcome) (void)database_.execute("ROLLBACK");
  return outcome;
}

SqlResult<void> JournalGroups::commit(const std::vector<Pending>& group) {
  return commit_after(group, 0);
}

SqlResult<void> JournalGroups::commit_again(const std::vector<Pending>& group) {
  const auto stored = database_.integer("SELECT coalesce(max(sequence),0) FROM commands");
  if (!stored) return std::unexpected(stored.error());
  return commit_after(group, static_cast<std::uint64_t>(*stored));
}

}  // namespace kerf
