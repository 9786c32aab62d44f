// SPDX-License-Identifier: Apache-2.0
// Encoding and decoding of the columns of a stock frame.

#include "server/convert/stock_columns.h"

#include "kernel/dexel/dexel_field.h"
#include "kernel/sculpture.h"
#include "tests/support/test.h"

namespace kerf::stock_columns_test {
namespace {

std::vector<std::byte> bytes_of(std::initializer_list<int> values) {
  std::vector<std::byte> bytes;
  for (const int value : values) bytes.push_back(static_cast<std::byte>(value));
  return bytes;
}

Sculpture carved(int cuts) {
  auto s = *Sculpture::create(
      {.stock = BoxStock{{0, 0, 0}, {16, 16, 12}}, .pitch_mm = 0.5, .keep_normals = false});
  s.apply(DefineTool{1, *make_tool(BallShape{4, 40})}).value();
  std::mt19937 random(7);
  std::uniform_real_distribution<double> at(0, 16), height(0, 10);
  for (int n = 0; n < cuts; ++n) {
    const Vec3 from{at(random), at(random), height(random)};
    const Vec3 to{at(random), at(random), height(random)};
    s.apply(MoveTool{1, {from, {0, 0.6, 0.8}}, {to, {0, 0.6, 0.8}}, 0, false}).value();
  }
  return s;
}

std::vector<Dexel> read(const DexelTile& tile, int place) {
  std::vector<Dexel> column;
  tile.read(place, column);
  return column;
}

TEST(StockColumns, RoundTrip) {
  const auto s = carved(8);
  const auto tile = s.field(RayAxis::kZ)->fresh({0, 0});
  const auto columns = test::value_of(decode_columns(encode_columns(*tile, nullptr)));
  ASSERT_EQ(columns.columns.size(), static_cast<std::size_t>(kTileColumns));
  std::size_t split = 0;
  for (int place = 0; place < kTileColumns; ++place) {
    const auto expected = read(*tile, place);
    const auto got = columns.of(static_cast<std::size_t>(place));
    EXPECT_EQ(std::vector<Dexel>(got.begin(), got.end()), expected) << place;
    split += expected.size() > 1;
  }
  EXPECT_GT(split, 20U) << "the cuts should split columns";
}

TEST(StockColumns, SecondEncodingContainsOnlyChangedColumns) {
  const auto before = carved(3).field(RayAxis::kZ)->fresh({0, 0});
  const auto after = carved(4).field(RayAxis::kZ)->fresh({0, 0});
  const auto whole = encode_columns(*after, nullptr);
  const auto changes = encode_columns(*after, before.get());
  EXPECT_LT(changes.size(), whole.size());
  const auto columns = test::value_of(decode_columns(changes));
  DexelTile copy = *before;
  EXPECT_TRUE(keep_common(copy, columns));
  for (int place = 0; place < kTileColumns; ++place) {
    EXPECT_EQ(read(copy, place), read(*after, place)) << place;
  }
  EXPECT_TRUE(encode_columns(*after, after.get()).empty());
}

TEST(StockColumns, UntouchedTileIsSmall) {
  const auto s = carved(0);
  EXPECT_LT(encode_columns(*s.field(RayAxis::kZ)->fresh({0, 0}), nullptr).size(), 12U);
}

TEST(StockColumns, MatchGoldenBytes) {
  // One column with an element from 10 to 300, two skipped, two columns from 11 to 300.
  const auto columns = test::value_of(
      decode_columns(bytes_of({0x05, 0x14, 0xC4, 0x04, 0x08, 0x05, 0x02, 0x00, 0x06})));
  ASSERT_EQ(columns.columns.size(), 3U);
  EXPECT_EQ(columns.columns[1].place, 3);
  EXPECT_EQ(columns.of(0)[0], (Dexel{10, 300}));
  EXPECT_EQ(columns.of(1)[0], (Dexel{11, 300}));
  EXPECT_EQ(columns.of(2)[0], (Dexel{11, 300}));
  EXPECT_TRUE(decode_columns({}));
}

TEST(StockColumns, MalformedColumnsAreRejected) {
  const auto rejected = [](std::initializer_list<int> values) {
    return !decode_columns(bytes_of(values)).has_value();
  };
  EXPECT_TRUE(rejected({0x03})) << "unknown token";
  EXPECT_TRUE(rejected({0x00})) << "skips no column";
  EXPECT_TRUE(rejected({0x06})) << "nothing to repeat";
  EXPECT_TRUE(rejected({0x84, 0x20})) << "1025 columns skipped";
  EXPECT_TRUE(rejected({0x05, 0x14})) << "ends inside a column";
  EXPECT_TRUE(rejected({0x85})) << "ends inside a number";
  EXPECT_TRUE(rejected({0x05, 0x14, 0x14, 0x00})) << "skips no column after a column";
  EXPECT_TRUE(rejected({0x05, 0x14, 0x00})) << "top not above bottom";
  EXPECT_TRUE(rejected({0x05, 0x01, 0x14})) << "below the block";
  EXPECT_TRUE(rejected({0x09, 0x00, 0x08, 0x00, 0x08})) << "elements without a gap";
  EXPECT_TRUE(rejected({0x05, 0x00, 0x80, 0x80, 0x80, 0x80, 0x08})) << "above 2^30";
}

TEST(StockColumns, RandomBytesAreRejectedOrValid) {
  const auto s = carved(8);
  const auto valid = encode_columns(*s.field(RayAxis::kZ)->fresh({0, 0}), nullptr);
  std::mt19937 random(11);
  std::size_t rejected = 0;
  for (int round = 0; round < 20000; ++round) {
    auto bytes = valid;
    bytes.resize(random() % (valid.size() + 1));
    for (int n = 0; n < 3 && !bytes.empty(); ++n) {
      bytes[random() % bytes.size()] = static_cast<std::byte>(random());
    }
    const auto columns = decode_columns(bytes);
    rejected += !columns.has_value();
    if (!columns) continue;
    std::int32_t last = -1;
    for (std::size_t n = 0; n < columns->columns.size(); ++n) {
      EXPECT_GT(columns->columns[n].place, last);
      last = columns->columns[n].place;
      std::int32_t below = -1;
      for (const Dexel& d : columns->of(n)) {
        ASSERT_LT(below, d.bottom);
        ASSERT_LT(d.bottom, d.top);
        below = d.top;
      }
    }
    EXPECT_LT(last, kTileColumns);
  }
  EXPECT_GT(rejected, 1000U);
}

}  // namespace
}  // namespace kerf::stock_columns_test
