// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <expected>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "server/history/record_source.h"
#include "server/store/batch_rows.h"
#include "server/store/record_batch.h"

namespace kerf::page {

/// The records of a journal in memory, as its file has them (web/manual/kerf-file.md): some ten
/// bytes a motion.
class RecordLog {
 public:
  /// Adds rows of batches (server/store/record_span.h). Rows that are there already are left out,
  /// so that spans may overlap. Records are verified when they are read. The error is one sentence.
  std::expected<void, std::string> add(std::span<const std::byte> rows);
  /// Adds records of the page's own, at most kBatchRecordsMax, as one row: the first was made at
  /// `wall_ms` since 1970, the last `span_ms` later (BatchHead).
  void append(std::span<const BatchRecord> records, std::int64_t wall_ms, std::int64_t span_ms);
  /// Returns all rows, as add() takes them.
  std::vector<std::byte> rows() const;
  /// Number of the last record.
  std::uint64_t last() const;
  /// When a record was appended, ms since 1970, UTC; 0: there is none.
  std::int64_t time_of(std::uint64_t record) const;
  /// As RecordSource::read.
  std::expected<void, std::string> read(
      std::span<const RecordRange> ranges,
      const std::function<void(JournalRecord& record)>& visit) const;

 private:
  struct Row {
    BatchHead head;
    std::int64_t crc = 0;
    std::vector<std::byte> bytes;
  };
  std::expected<void, std::string> read_range(
      const RecordRange& range, const std::function<void(JournalRecord& record)>& visit) const;
  std::vector<Row>::const_iterator row_of(std::uint64_t record) const;

  std::vector<Row> rows_;  ///< ascending, without gaps
  BatchEncoder encoder_;   ///< of append(): its first batch needs none of those before
};

/// Returns the records of a log, which others may extend.
std::unique_ptr<RecordSource> log_records(std::shared_ptr<const RecordLog> log);

}  // namespace kerf::page
