// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <expected>
#include <filesystem>
#include <memory>
#include <optional>
#include <stop_token>
#include <vector>

#include "server/store/journal_branch.h"
#include "server/store/journal_error.h"
#include "server/store/journal_file.h"
#include "server/store/journal_record.h"
#include "server/store/list_table.h"
#include "server/store/record_rows.h"
#include "server/store/resume_token.h"

namespace kerf {

/// A participant as stored in the journal.
struct JournalParticipant {
  ParticipantId participant = 0;
  std::string name, color, kind;
  std::optional<TokenHash> token = std::nullopt;  ///< set if the agent may resume
  /// Number of the agent's newest sample in the journal; 0 if none. Ignored when writing: commands
  /// update it.
  std::uint64_t agent_sequence = 0;
  bool is_removed = false;  ///< write only: forget the agent's token
};

/// The hash of the solid after the record `sequence`.
struct StateHash {
  std::uint64_t sequence = 0;
  std::uint64_t hash = 0;
};

/// The order in which a reader returns the records.
enum class RecordOrder {
  kSequence,
  kParticipant  ///< participant by participant, each in sequence; sorted by SQLite on disk
};

/// Reads a journal from its beginning and verifies each record. May run in parallel with a writer
/// of the file and reads the state committed when it was opened.
class JournalReader {
 public:
  /// Begins with record `from` (RecordRows::open). Reading and sorting fail soon after a stop was
  /// requested.
  static std::expected<JournalReader, JournalError> open(const std::filesystem::path& file,
                                                         RecordOrder order = RecordOrder::kSequence,
                                                         std::stop_token stop = {},
                                                         std::uint64_t from = 1);

  const JournalHeader& header() const { return header_; }
  const std::vector<JournalParticipant>& participants() const { return participants_; }
  /// Sorted by sequence. All are of existing records.
  const std::vector<StateHash>& state_hashes() const { return hashes_; }
  /// The lists that people keep with the block, as of the last record.
  const Lists& lists() const { return lists_; }
  /// The session from which this one was branched; empty id if none.
  const JournalParent& parent() const { return parent_; }
  /// Number of state hashes ignored because they are beyond the last record: the journal has lost
  /// records.
  std::size_t dropped_hashes() const { return dropped_hashes_; }
  /// Rows ignored everywhere because of wrong checksums.
  struct DamagedRows {
    std::string table;
    std::int64_t rows = 0;
  };
  /// Returns the damaged rows by table, except for records; empty if none.
  std::expected<std::vector<DamagedRows>, JournalError> damaged_rows();
  /// Number of the last record.
  std::uint64_t last_sequence() const { return rows_->last(); }
  /// Returns a hash of the session, its scene and the row of record `sequence` with its time, which
  /// identifies the journal up to this record. Nullopt if there is no such record.
  std::expected<std::optional<std::uint64_t>, JournalError> mark(std::uint64_t sequence);
  /// Returns the next record; nullopt after the last. An error names the first bad record in the
  /// order of reading, and reading stops there.
  std::expected<std::optional<JournalRecord>, JournalError> next();

 private:
  JournalReader(std::filesystem::path file, SqlDatabase database, RecordOrder order,
                std::stop_token stop);
  std::expected<void, JournalError> read_head();
  std::expected<void, JournalError> read_agents();
  std::expected<bool, JournalError> has_table(const std::string& name);
  std::expected<void, JournalError> read_kernel_version(std::int64_t last);
  std::expected<std::int64_t, JournalError> integer(const std::string& sql);
  JournalError corrupt(std::uint64_t sequence, std::string reason) const;

  std::filesystem::path file_;
  std::unique_ptr<SqlDatabase> database_;  ///< stable address, for `rows_`
  std::optional<RecordRows> rows_;
  std::optional<SortedRecords> sorted_;
  JournalHeader header_;
  std::vector<JournalParticipant> participants_;
  std::vector<StateHash> hashes_;
  Lists lists_;
  JournalParent parent_;
  std::size_t dropped_hashes_ = 0;
  RecordOrder order_;
  std::stop_token stop_;
};

}  // namespace kerf
