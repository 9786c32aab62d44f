// SPDX-License-Identifier: Apache-2.0
#include "kernel/cut/block_places.h"

#include "tests/support/test.h"

namespace kerf::block_places_test {
namespace {

TEST(BlockPlaces, StockReachesFromTheLowestElementToTheTop) {
  DexelGrid grid{.origin_mm = {0, 0, -2}, .z_quantum_mm = 0.5};
  grid.columns_x = grid.columns_y = kTileSide;
  grid.height_quanta = 100;
  DexelTile tile;
  tile.bottom.fill(10);
  tile.top.fill(40);
  const int corner = 8 * kTileSide + 16;
  tile.write(corner + 3 * kTileSide + 5, std::vector<Dexel>{{4, 6}, {8, 20}, {30, 90}});
  tile.write(corner + 1, {});
  ColumnBlock block;
  place_stock(grid, &tile, corner, 0b1001, block);
  EXPECT_EQ(block.stock_lo_mm[3][4], 3);
  EXPECT_EQ(block.stock_hi_mm[3][4], 18);
  EXPECT_EQ(block.stock_lo_mm[3][5], 0);
  EXPECT_EQ(block.stock_hi_mm[3][5], 43);
  EXPECT_GE(block.stock_lo_mm[0][1], block.stock_hi_mm[0][1]);                   // an empty column
  EXPECT_EQ(block.stock_lo_mm[2][0], -std::numeric_limits<double>::infinity());  // not asked
  place_stock(grid, nullptr, corner, 0b1000, block);
  EXPECT_EQ(block.stock_lo_mm[3][5], -2);
  EXPECT_EQ(block.stock_hi_mm[3][5], 48);
}

}  // namespace
}  // namespace kerf::block_places_test
