// SPDX-License-Identifier: Apache-2.0
#include "server/store/batch_rows.h"

#include <utility>

namespace kerf {
namespace {

/// Rejects numbers that no writer stores, whose sums could overflow.
bool is_valid(const BatchHead& head) {
  return head.count >= 1 && head.count <= kBatchRecordsMax && head.wall_ms >= -kWallMaxMs &&
         head.wall_ms <= kWallMaxMs && head.span_ms >= 0 && head.span_ms <= kSpanMaxMs;
}

}  // namespace

std::expected<void, BadBatch> verify_row(const BatchRow& row, std::uint64_t last) {
  const BatchHead& head = row.head;
  const auto bad = [](std::uint64_t sequence, std::string reason) {
    return std::unexpected(BadBatch{sequence, std::move(reason)});
  };
  if (head.first != last + 1) {
    return bad(last + 1, "the record is missing: the next one is " + std::to_string(head.first));
  }
  if (!is_valid(head)) {
    return bad(head.first, "the number or the time of the records is invalid");
  }
  if (row.crc != std::int64_t{batch_checksum(head, row.bytes)}) {
    return bad(head.first, "the checksum of the records is wrong");
  }
  return {};
}

std::expected<std::vector<JournalRecord>, BadBatch> BatchRows::read(const BatchRow& row,
                                                                    std::uint64_t last) {
  if (auto good = verify_row(row, last); !good) return std::unexpected(std::move(good.error()));
  const BatchHead& head = row.head;
  auto decoded = decoder_.decode(row.bytes, static_cast<std::size_t>(head.count));
  if (!decoded) return std::unexpected(BadBatch{head.first, decoded.error()});
  std::vector<JournalRecord> records;
  records.reserve(decoded->size());
  for (BatchRecord& record : *decoded) {
    const std::uint64_t sequence = head.first + records.size();
    std::uint64_t& stroke = strokes_[record.participant];
    if (record.begins_stroke) stroke = sequence;
    records.push_back({sequence, record.participant, std::move(record.command),
                       head.wall_ms_of(records.size()), stroke});
  }
  return records;
}

}  // namespace kerf
