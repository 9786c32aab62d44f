// SPDX-License-Identifier: Apache-2.0
#include "kernel/dexel/stock_column.h"

#include "kernel/dexel/column_shares.h"
#include "kernel/dexel/dexel_tile.h"
#include "tests/support/test.h"

namespace kerf::stock_column_test {
namespace {

constexpr std::array kAxes{RayAxis::kX, RayAxis::kY, RayAxis::kZ};

TEST(RayAxis, FramesAreExactCyclicPermutations) {
  const Vec3 v{0.1, 1e300, -0.0};
  for (const RayAxis axis : kAxes) {
    EXPECT_EQ(from_frame(axis, to_frame(axis, v)), v);
    // Right-handed: the frame's unit vectors keep their cross product.
    const Vec3 x = from_frame(axis, {1, 0, 0}), y = from_frame(axis, {0, 1, 0});
    EXPECT_EQ(cross(x, y), from_frame(axis, Vec3{0, 0, 1}));
  }
  EXPECT_EQ(from_frame(RayAxis::kX, {0, 0, 1}), (Vec3{1, 0, 0}));
  EXPECT_EQ(from_frame(RayAxis::kY, {0, 0, 1}), (Vec3{0, 1, 0}));
}

TEST(Grid, QuantumDependsOnTheFieldsHeight) {
  const StockShape stock = BoxStock{{0, 0, 0}, {1000, 3, 40}};
  for (const RayAxis axis : kAxes) {
    const DexelGrid grid = make_grid(stock, 0.5, axis);
    const double height = to_frame(axis, Vec3{1000, 3, 40}).z;
    EXPECT_GE(grid.height_quanta, 1 << 29) << int(axis);
    EXPECT_EQ(grid.height_quanta * grid.z_quantum_mm, height);
    int exponent = 0;
    EXPECT_EQ(std::frexp(grid.z_quantum_mm, &exponent), 0.5);
    EXPECT_EQ(grid.axis, axis);
  }
  EXPECT_EQ(make_grid(stock, 0.5, RayAxis::kX).columns_x, 6);
  EXPECT_EQ(make_grid(stock, 0.5, RayAxis::kX).columns_y, 80);
  EXPECT_EQ(make_grid(stock, 0.5, RayAxis::kY).columns_x, 80);
  EXPECT_EQ(make_grid(stock, 0.5, RayAxis::kY).columns_y, 2000);
}

TEST(CylinderStock, RayAcrossTheAxisIsAChord) {
  const StockShape stock = CylinderStock{7, -3, 5, 0, 10};
  for (const RayAxis axis : {RayAxis::kX, RayAxis::kY}) {
    const DexelGrid grid = make_grid(stock, 0.5, axis);
    const double center = axis == RayAxis::kX ? 7 : -3;
    for (std::int32_t k = 0; k < 20; ++k) {
      const double aside = -5 + (k + 0.5) * 0.5;
      const double half = std::sqrt(25 - aside * aside);
      const Dexel d =
          axis == RayAxis::kX ? stock_column(stock, grid, k, 3) : stock_column(stock, grid, 3, k);
      EXPECT_NEAR(grid.z_mm(d.bottom), center - half, grid.z_quantum_mm) << k;
      EXPECT_NEAR(grid.z_mm(d.top), center + half, grid.z_quantum_mm) << k;
    }
  }
}

TEST(CylinderStock, TangentRayIsEmpty) {
  // Pitch 2 and radius 1: the only column of a row passes through the axis; shifted by the radius
  // it is tangent.
  const CylinderStock stock{0, 0, 1, 0, 4};
  DexelGrid grid = make_grid(stock, 2, RayAxis::kX);
  EXPECT_EQ(stock_column(stock, grid, 0, 0), (Dexel{0, grid.height_quanta}));
  for (const double aside : {-1.0, 1.0}) {
    grid.origin_mm.x = aside - 1;
    const Dexel d = stock_column(stock, grid, 0, 0);
    EXPECT_EQ(d.bottom, d.top);
  }
}

TEST(CylinderStock, VolumeMatchesTheSumOfColumns) {
  for (const auto& stock : {CylinderStock{0, 0, 5, 0, 10}, CylinderStock{7.3, -3.1, 4.77, -2, 3.3},
                            CylinderStock{0.1, 0.2, 0.3, 0, 1}, CylinderStock{1e4, 1e4, 2, 0, 9}}) {
    for (const RayAxis axis : kAxes) {
      for (const double pitch : {0.1, 0.37, 3.0}) {
        const DexelGrid grid = make_grid(stock, pitch, axis);
        const ColumnShares shares(stock, grid);
        double sum = 0;
        for (std::int32_t j = 0; j < grid.columns_y; ++j) {
          for (std::int32_t i = 0; i < grid.columns_x; ++i) {
            const Dexel d = stock_column(stock, grid, i, j);
            sum += (d.top - d.bottom) * shares.of(i, j);
          }
        }
        EXPECT_NEAR(stock_quanta(stock, grid), sum, 1e-12 * sum) << int(axis) << ' ' << pitch;
      }
    }
  }
}

TEST(Stock, FilledTileEqualsStockColumns) {
  const StockShape stock = CylinderStock{0, 0, 11, 0, 10};
  for (const RayAxis axis : kAxes) {
    const DexelGrid grid = make_grid(stock, 0.4, axis);
    DexelTile tile;
    fill_from_stock(stock, grid, {1, 0}, tile);
    std::vector<Dexel> column;
    for (std::int32_t c = 0; c < kTileColumns; ++c) {
      const std::int32_t i = kTileSide + c % kTileSide, j = c / kTileSide;
      tile.read(c, column);
      const Dexel whole = stock_column(stock, grid, i, j);
      const bool empty = i >= grid.columns_x || j >= grid.columns_y || whole.bottom == whole.top;
      ASSERT_EQ(column.size(), empty ? 0u : 1u);
      if (!empty) {
        EXPECT_EQ(column[0], whole);
      }
    }
  }
}

}  // namespace
}  // namespace kerf::stock_column_test
