// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <expected>
#include <filesystem>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "server/store/batch_rows.h"
#include "server/store/journal_error.h"
#include "server/store/journal_record.h"
#include "server/store/sqlite.h"

namespace kerf {

/// Reads and verifies the records of a journal in sequence: the single rows of version 1, if any,
/// then the batches.
class RecordRows {
 public:
  /// Begins with record `from`, or with the first record of a salvaged journal (journal_base.h).
  /// Batches before the one with that record are not verified, and records of a stroke that began
  /// earlier have stroke 0. `database` must outlive the result. Fails with the error of SQLite.
  static std::expected<RecordRows, JournalError> open(const std::filesystem::path& file,
                                                      SqlDatabase& database,
                                                      std::uint64_t from = 1);
  /// Returns the next record; nullopt after the last. An error names the first bad record, in a
  /// batch its first record.
  std::expected<std::optional<JournalRecord>, JournalError> next();
  /// Sequence of the last record.
  std::uint64_t last() const { return last_; }

 private:
  explicit RecordRows(std::filesystem::path file) : file_(std::move(file)) {}
  SqlResult<void> prepare(SqlDatabase& database, std::uint64_t from);
  std::expected<std::optional<JournalRecord>, JournalError> next_of_all();
  JournalError corrupt(std::uint64_t sequence, std::string reason) const;
  std::expected<std::optional<JournalRecord>, JournalError> next_single();
  std::expected<bool, JournalError> next_batch();
  std::expected<bool, JournalError> step(SqlStatement& rows) const;

  std::filesystem::path file_;
  std::optional<SqlStatement> singles_, batches_;  ///< empty without a table or further rows
  BatchRows rows_;
  std::vector<JournalRecord> batch_;  ///< decoded records
  std::size_t at_ = 0;                ///< index in batch_
  std::uint64_t last_ = 0;
  std::uint64_t count_ = 0;  ///< last record of the rows read so far
  std::uint64_t from_ = 1;
};

/// The records of a journal, participant by participant, each in sequence. SQLite sorts them in a
/// temporary file, which is deleted with this object.
class SortedRecords {
 public:
  /// Reads all rows. Fails soon after a stop was requested.
  static std::expected<SortedRecords, JournalError> sort(RecordRows& rows,
                                                         const std::filesystem::path& file,
                                                         const std::stop_token& stop);
  std::expected<std::optional<JournalRecord>, JournalError> next();

 private:
  SortedRecords(std::filesystem::path file, SqlDatabase database, SqlStatement rows)
      : file_(std::move(file)), database_(std::move(database)), rows_(std::move(rows)) {}

  std::filesystem::path file_;
  SqlDatabase database_;
  SqlStatement rows_;  // destroyed before the database
};

/// Returns the first record of the last restarting batch that begins at or before record `from`; 0
/// if there is none, e.g. if record `from` is a single row of version 1.
SqlResult<std::int64_t> restart_before(SqlDatabase& database, std::uint64_t from);
/// Returns the current row of a query for first, count, wall_ms, span_ms, bytes and crc of
/// `batches`. Its bytes are valid until the next step.
BatchRow batch_of(const SqlStatement& row);
/// Returns the sequence of the last record of a journal; 0 if it has none.
SqlResult<std::uint64_t> last_record(SqlDatabase& database);

}  // namespace kerf
