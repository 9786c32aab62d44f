// SPDX-License-Identifier: Apache-2.0
#include "server/store/record_span.h"

#include "server/store/journal_origin.h"
#include "tests/support/test.h"

namespace kerf::record_span_test {
namespace {

std::vector<std::byte> bytes_of(std::initializer_list<int> values) {
  std::vector<std::byte> bytes;
  for (const int value : values) bytes.push_back(static_cast<std::byte>(value));
  return bytes;
}

// The layout is an interface: other programs read it.
TEST(RecordSpan, HasTheseBytes) {
  const std::vector<std::byte> content = bytes_of({0xAB, 0xCD});
  std::vector<std::byte> span;
  append_span_row(span, {{0x0102, 3, -2, 5}, -1, content});
  EXPECT_EQ(span,
            bytes_of({2, 1, 0,    0,    0,    0,    0,    0,    3,    0,    0, 0, 0,    0,
                      0, 0, 0xFE, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 5, 0, 0,    0,
                      0, 0, 0,    0,    0xFF, 0xFF, 0xFF, 0xFF, 2,    0,    0, 0, 0xAB, 0xCD}));
  std::span<const std::byte> rest = span;
  const auto row = test::value_of(take_span_row(rest));
  EXPECT_TRUE(rest.empty());
  EXPECT_EQ(row.head.first, 0x0102U);
  EXPECT_EQ(row.head.wall_ms, -2);
  EXPECT_EQ(row.crc, -1);
  EXPECT_TRUE(std::ranges::equal(row.bytes, content));
}

TEST(RecordSpan, TruncatedOrImpossibleSpanIsRejected) {
  std::vector<std::byte> span;
  append_span_row(span, {{1, 3, 0, 0}, 0, bytes_of({1, 2, 3})});
  for (std::size_t size = 1; size < span.size(); ++size) {
    std::span<const std::byte> cut = std::span(span).first(size);
    EXPECT_FALSE(take_span_row(cut)) << size;
  }
  for (const BatchHead& head :
       {BatchHead{0, 1, 0, 0}, BatchHead{1, 0, 0, 0}, BatchHead{1, kBatchRecordsMax + 1, 0, 0},
        BatchHead{~std::uint64_t{0}, 2, 0, 0}}) {
    std::vector<std::byte> bad;
    append_span_row(bad, {head, 0, {}});
    std::span<const std::byte> rest = bad;
    EXPECT_FALSE(take_span_row(rest)) << head.first << ' ' << head.count;
  }
}

TEST(JournalOrigin, RoundTrips) {
  const JournalOrigin origin{"block", "{}", {{"a.stl", std::string("\0x", 2)}, {"b.ply", ""}}};
  const std::vector<std::byte> bytes = encode_origin(origin);
  const auto read = test::value_of(read_origin(bytes));
  EXPECT_EQ(read.session, origin.session);
  EXPECT_EQ(read.scene_json, origin.scene_json);
  EXPECT_EQ(read.files, origin.files);
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    EXPECT_FALSE(read_origin(std::span(bytes).first(size))) << size;
  }
}

TEST(JournalOrigin, HasTheseBytes) {
  EXPECT_EQ(encode_origin({"b", "{}", {}}),
            bytes_of({2, 0, 0, 0, 1, 0, 0, 0, 'b', 2, 0, 0, 0, '{', '}'}));
}

}  // namespace
}  // namespace kerf::record_span_test
