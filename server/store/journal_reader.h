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
  /// Number of the newest sample of the agent that is in the journal; 0: none. Read only: it is
  /// written with the commands.
  std::uint64_t agent_sequence = 0;
  bool is_removed = false;  ///< write only: its token, if it has one, is forgotten
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

/// Reads a journal from its beginning and verifies each record. May run beside a writer of the same
/// file; it reads the state that was committed when it was opened.
class JournalReader {
 public:
  /// Reading, and the sorting before it, fails soon after a stop was requested. Begins with record
  /// `from` (RecordRows::open).
  static std::expected<JournalReader, JournalError> open(const std::filesystem::path& file,
                                                         RecordOrder order = RecordOrder::kSequence,
                                                         std::stop_token stop = {},
                                                         std::uint64_t from = 1);

  const JournalHeader& header() const { return header_; }
  const std::vector<JournalParticipant>& participants() const { return participants_; }
  /// Sorted by sequence; none is beyond the last record.
  const std::vector<StateHash>& state_hashes() const { return hashes_; }
  /// The lists that people keep with the block, up to the last record.
  const Lists& lists() const { return lists_; }
  /// The session from a point of which this one began; its id is empty if there is none.
  const JournalParent& parent() const { return parent_; }
  /// Number of state hashes that were left out because they are beyond the last record: the journal
  /// has lost the records before them.
  std::size_t dropped_hashes() const { return dropped_hashes_; }
  /// Rows that are left out everywhere because their checksums are wrong.
  struct DamagedRows {
    std::string table;
    std::int64_t rows = 0;
  };
  /// Returns those of the tables beside the records, by table; none: all are good.
  std::expected<std::vector<DamagedRows>, JournalError> damaged_rows();
  /// Number of the last record.
  std::uint64_t last_sequence() const { return rows_->last(); }
  /// Returns a number that tells the journal, as far as record `sequence`, from another one: of the
  /// session, its scene, and the row of that record with its time. Nullopt if it has no such
  /// record.
  std::expected<std::optional<std::uint64_t>, JournalError> mark(std::uint64_t sequence);
  /// Returns the next record; nullopt after the last. An error names a bad record, the first one in
  /// the order of reading, and reading stops there.
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
  std::unique_ptr<SqlDatabase> database_;  ///< in one place, for `rows_`
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
