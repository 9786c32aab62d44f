// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <variant>
#include <vector>

#include "server/store/attachment.h"
#include "server/store/journal_reader.h"
#include "server/store/journal_record.h"
#include "server/store/list_table.h"
#include "server/store/record_batch.h"
#include "server/store/sqlite.h"

namespace kerf {

/// Data stored with a command.
struct RecordNote {
  std::uint64_t agent_sequence = 0;  ///< number of the agent's sample; 0 if not from an agent
  bool begins_stroke = false;
  std::uint32_t program_line = 0;  ///< line of a program's motion; 0 if not from a program
};

struct PendingCommand {
  std::uint64_t sequence = 0;
  ParticipantId participant = 0;
  RecordedCommand command;
  RecordNote note;
  std::int64_t wall_ms = 0;
};
/// A hash that replaces those of another kernel version.
struct RecarvedHash {
  StateHash state;
};
/// An uncommitted row of a journal.
using Pending = std::variant<PendingCommand, JournalParticipant, StateHash, RecarvedHash,
                             ListChange, AttachmentChange>;

/// Commits groups of rows to a journal, each in one transaction. The commands of a group form one
/// batch.
class JournalGroups {
 public:
  /// `database` must be open for writing.
  static SqlResult<JournalGroups> prepare(SqlDatabase database);

  /// Commits a group. An error means that nothing of it is stored, as far as SQLite knows: after a
  /// failed sync, that is uncertain.
  SqlResult<void> commit(const std::vector<Pending>& group);
  /// Retries a failed commit. Skips the batch if it is stored after all.
  SqlResult<void> commit_again(const std::vector<Pending>& group);

 private:
  struct Inserts {
    SqlStatement batch, participant, hash, version, agent, progress, token, removal;
  };
  JournalGroups(SqlDatabase database, Inserts inserts, std::int64_t last_attachment);
  /// The encoded commands of a group. Encoded only once, because each batch builds on the one
  /// before.
  struct Batch {
    BatchHead head;
    std::vector<std::byte> bytes;
  };
  Batch encode(const std::vector<Pending>& group);
  SqlResult<void> encode_once(const std::vector<Pending>& group);
  SqlResult<void> insert_all(const std::vector<Pending>& group, std::uint64_t stored);
  SqlResult<void> commit_after(const std::vector<Pending>& group, std::uint64_t stored);
  SqlResult<void> insert_batch();
  SqlResult<void> note_progress(const std::vector<Pending>& group);
  SqlResult<void> note_lines(const std::vector<Pending>& group);
  SqlResult<void> insert(const Pending& pending);

  BatchEncoder encoder_;
  Batch batch_;                       ///< of the newest group
  bool is_encoded_ = false;           ///< `batch_` is complete
  std::int64_t last_attachment_ = 0;  ///< greatest number given so far
  SqlDatabase database_;
  Inserts inserts_;  // destroyed before the database
};

}  // namespace kerf
