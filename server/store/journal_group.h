// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <variant>
#include <vector>

#include "server/store/journal_reader.h"
#include "server/store/journal_record.h"
#include "server/store/sqlite.h"

namespace kerf {

struct PendingCommand {
  std::uint64_t sequence;
  ParticipantId participant;
  std::vector<std::byte> bytes;
  std::uint64_t agent_sequence = 0;  ///< of the agent's sample; 0: not an agent's
};
/// A hash that another version of the kernel would not compute.
struct RecarvedHash {
  StateHash state;
};
/// One row of a journal that has not been committed.
using Pending = std::variant<PendingCommand, JournalParticipant, StateHash, RecarvedHash>;

/// Commits groups of rows to the tables of a journal, each in one transaction.
class JournalGroups {
 public:
  /// `database` was opened for writing.
  static SqlResult<JournalGroups> prepare(SqlDatabase database);

  /// Commits a group. After an error nothing of it is stored, as far as SQLite can tell: a failed
  /// sync leaves that open.
  SqlResult<void> commit(const std::vector<Pending>& group);
  /// Commits a group whose commit has failed; skips the commands that are stored after all.
  SqlResult<void> commit_again(const std::vector<Pending>& group);

 private:
  struct Inserts {
    SqlStatement command, participant, hash, version, agent, progress;
  };
  JournalGroups(SqlDatabase database, Inserts inserts);
  SqlResult<void> commit_after(const std::vector<Pending>& group, std::uint64_t stored);
  SqlResult<void> note_progress(const std::vector<Pending>& group);
  SqlResult<void> insert(const Pending& pending, std::uint64_t stored);

  SqlDatabase database_;
  Inserts inserts_;  // destroyed before the database
};

}  // namespace kerf
