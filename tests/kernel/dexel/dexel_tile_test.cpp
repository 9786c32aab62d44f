// SPDX-License-Identifier: Apache-2.0
#include "kernel/dexel/dexel_tile.h"

#include "tests/support/test.h"

namespace kerf::dexel_tile_test {
namespace {

/// Returns `count` elements with gaps between them, which depend on the seed.
std::vector<Dexel> some_elements(int count, std::int32_t seed) {
  std::vector<Dexel> elements;
  for (std::int32_t k = 0; k < count; ++k) {
    elements.push_back({10 * k + seed % 5, 10 * k + 6 + seed % 3});
  }
  return elements;
}

DexelTile whole_tile() {
  DexelTile tile;
  tile.bottom.fill(0);
  tile.top.fill(1000);
  tile.update_bounds();
  return tile;
}

std::vector<Dexel> read(const DexelTile& tile, int column) {
  std::vector<Dexel> out;
  tile.read(column, out);
  return out;
}

TEST(DexelTile, ReadsBackRandomWrites) {
  DexelTile tile = whole_tile();
  std::map<int, std::vector<Dexel>> expected;
  std::mt19937 random(7);
  for (int step = 0; step < 20000; ++step) {
    const int column = static_cast<int>(random() % kTileColumns);
    // Often zero or one element, mostly few, sometimes very many.
    const int count = static_cast<int>(random() % 8 == 0 ? random() % 200 : random() % 5);
    expected[column] = some_elements(count, step);
    tile.write(column, expected[column]);
    const int other = static_cast<int>(random() % kTileColumns);
    if (expected.contains(other)) {
      ASSERT_EQ(read(tile, other), expected[other]) << "step " << step;
    }
  }
  for (const auto& [column, elements] : expected) {
    EXPECT_EQ(read(tile, column), elements);
    EXPECT_EQ(tile.is_split(column), elements.size() > 1);
  }
}

TEST(DexelTile, CopyIsIndependent) {
  DexelTile tile = whole_tile();
  tile.write(5, some_elements(9, 1));
  DexelTile copy = tile;
  copy.write(5, some_elements(3, 2));
  copy.write(6, some_elements(30, 2));
  EXPECT_EQ(read(tile, 5), some_elements(9, 1));
  EXPECT_EQ(read(tile, 6), (std::vector<Dexel>{{0, 1000}}));
  EXPECT_EQ(read(copy, 5), some_elements(3, 2));
}

TEST(DexelTile, ColumnOfOneElementTakesLessThanTwiceItsSize) {
  const DexelTile tile = whole_tile();
  EXPECT_LT(tile.bytes(), 2 * kTileColumns * sizeof(Dexel));
}

TEST(DexelTile, ManyElementsTakeAFewTimesTheirSize) {
  DexelTile tile = whole_tile();
  for (int column = 0; column < kTileColumns; ++column) tile.write(column, some_elements(40, 1));
  EXPECT_LT(tile.bytes(), std::size_t{4} * 40 * kTileColumns * sizeof(Dexel));
}

TEST(DexelTile, ReusesMemoryOfRemovedElements) {
  DexelTile tile = whole_tile();
  for (int column = 0; column < 100; ++column) tile.write(column, some_elements(40, 1));
  const std::size_t bytes = tile.bytes();
  for (int round = 0; round < 1000; ++round) {
    for (int column = 0; column < 100; ++column) {
      tile.write(column, some_elements(round % 2 == 0 ? 1 : 40, round));
    }
  }
  // Only the free list of runs may have grown.
  EXPECT_LE(tile.bytes(), bytes + 256);
}

TEST(DexelTile, BlockTopsAreTheGreatestTops) {
  DexelTile tile = whole_tile();
  EXPECT_EQ(std::ranges::max(tile.block_top), 1000);
  for (int column = 0; column < kTileColumns; ++column) tile.write(column, {});
  tile.write(77, some_elements(2, 0));
  tile.update_bounds();
  EXPECT_EQ(std::ranges::max(tile.block_top), 16);
}

}  // namespace
}  // namespace kerf::dexel_tile_test
