// SPDX-License-Identifier: Apache-2.0
#include "web/wasm/files/record_log.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "server/store/record_span.h"

namespace kerf::page {
namespace {

using Done = std::expected<void, std::string>;
using Visit = std::function<void(JournalRecord& record)>;

class LogRecords final : public RecordSource {
 public:
  explicit LogRecords(std::shared_ptr<const RecordLog> log) : log_(std::move(log)) {}
  Done read(std::span<const RecordRange> ranges, const Visit& visit,
            const std::stop_token& /*stop*/) override {
    return log_->read(ranges, visit);
  }

 private:
  std::shared_ptr<const RecordLog> log_;
};

std::string record_error(const BadBatch& bad) {
  return "record " + std::to_string(bad.sequence) + ": " + bad.reason;
}

}  // namespace

Done RecordLog::add(std::span<const std::byte> rows) {
  while (!rows.empty()) {
    const auto row = take_span_row(rows);
    if (!row) return std::unexpected(row.error());
    const BatchHead& head = row->head;
    if (head.first + head.count <= last() + 1) continue;
    if (head.first != last() + 1) {
      return std::unexpected(record_error(
          {last() + 1, "the record is missing: the next one is " + std::to_string(head.first)}));
    }
    if (rows_.empty() && !restarts(row->bytes)) {
      return std::unexpected(record_error({head.first, "the records before it are missing"}));
    }
    rows_.push_back({head, row->crc, {row->bytes.begin(), row->bytes.end()}});
  }
  return {};
}

void RecordLog::append(std::span<const BatchRecord> records, std::int64_t wall_ms,
                       std::int64_t span_ms) {
  if (records.empty()) return;
  const BatchHead head{last() + 1, records.size(), wall_ms, span_ms};
  std::vector<std::byte> bytes = encoder_.encode(records);
  const std::int64_t crc = batch_checksum(head, bytes);
  rows_.push_back({head, crc, std::move(bytes)});
}

std::vector<std::byte> RecordLog::rows() const {
  std::vector<std::byte> all;
  for (const Row& row : rows_) append_span_row(all, {row.head, row.crc, row.bytes});
  return all;
}

std::uint64_t RecordLog::last() const {
  return rows_.empty() ? 0 : rows_.back().head.first + rows_.back().head.count - 1;
}

/// The row that holds a record, which is at most last() and not 0.
std::vector<RecordLog::Row>::const_iterator RecordLog::row_of(std::uint64_t record) const {
  const auto after =
      std::ranges::upper_bound(rows_, record, {}, [](const Row& row) { return row.head.first; });
  return std::prev(after);
}

std::int64_t RecordLog::time_of(std::uint64_t record) const {
  if (record == 0 || record > last()) return 0;
  const BatchHead& head = row_of(record)->head;
  return head.wall_ms_of(record - head.first);
}

Done RecordLog::read_range(const RecordRange& range, const Visit& visit) const {
  if (range.first > last()) return {};
  auto row = row_of(std::max<std::uint64_t>(range.first, 1));
  while (row != rows_.begin() && !restarts(row->bytes)) --row;
  BatchRows batches;
  for (; row != rows_.end() && row->head.first <= range.last; ++row) {
    auto records = batches.read({row->head, row->crc, row->bytes}, row->head.first - 1);
    if (!records) return std::unexpected(record_error(records.error()));
    for (JournalRecord& record : *records) {
      if (record.sequence >= range.first && record.sequence <= range.last) visit(record);
    }
  }
  return {};
}

Done RecordLog::read(std::span<const RecordRange> ranges, const Visit& visit) const {
  for (const RecordRange& range : ranges) {
    if (auto done = read_range(range, visit); !done) return done;
  }
  return {};
}

std::unique_ptr<RecordSource> log_records(std::shared_ptr<const RecordLog> log) {
  return std::make_unique<LogRecords>(std::move(log));
}

}  // namespace kerf::page
