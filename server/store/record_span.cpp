// SPDX-License-Identifier: Apache-2.0
#include "server/store/record_span.h"

#include "server/store/byte_code.h"

namespace kerf {

void append_span_row(std::vector<std::byte>& span, const BatchRow& row) {
  ByteWriter head;
  head.put(row.head.first);
  head.put(row.head.count);
  head.put(static_cast<std::uint64_t>(row.head.wall_ms));
  head.put(static_cast<std::uint64_t>(row.head.span_ms));
  head.put(static_cast<std::uint32_t>(row.crc));
  head.put(static_cast<std::uint32_t>(row.bytes.size()));
  const std::vector<std::byte> bytes = head.take();
  span.insert(span.end(), bytes.begin(), bytes.end());
  span.insert(span.end(), row.bytes.begin(), row.bytes.end());
}

std::expected<BatchRow, std::string> take_span_row(std::span<const std::byte>& span) {
  ByteReader in(span);
  BatchRow row;
  row.head.first = in.get<std::uint64_t>();
  row.head.count = in.get<std::uint64_t>();
  row.head.wall_ms = static_cast<std::int64_t>(in.get<std::uint64_t>());
  row.head.span_ms = static_cast<std::int64_t>(in.get<std::uint64_t>());
  row.crc = static_cast<std::int32_t>(in.get<std::uint32_t>());
  row.bytes = in.get_bytes(in.get<std::uint32_t>());
  if (in.truncated()) return std::unexpected("the span ends within a row of records");
  // Further errors are found when the row is decoded, but these would affect sums before that.
  if (row.head.first == 0 || row.head.count == 0 || row.head.count > kBatchRecordsMax ||
      row.head.first > std::uint64_t{1} << 63U) {
    return std::unexpected("the numbers of a row of records are invalid");
  }
  span = span.subspan(kSpanRowHeadBytes + row.bytes.size());
  return row;
}

}  // namespace kerf
