// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/device/carving_figure.h"

#include "tests/support/test.h"

namespace kerf::agent::carving_figure_test {
namespace {

class FigureInStock : public ::testing::TestWithParam<StockBox> {};

TEST_P(FigureInStock, CutsInsideAndMovesAboveTheBlock) {
  const StockBox stock = GetParam();
  const Vec3 size = stock.max_mm - stock.min_mm;
  const PoseScript script = make_carving_figure(stock, 3);
  ASSERT_GT(script.size(), 1000U);
  double deepest_mm = 0;
  for (std::size_t i = 0; i < script.size(); ++i) {
    const TimedPose& pose = script[i];
    EXPECT_GT(pose.tip_mm.x, stock.min_mm.x);
    EXPECT_LT(pose.tip_mm.x, stock.max_mm.x);
    EXPECT_GT(pose.tip_mm.y, stock.min_mm.y);
    EXPECT_LT(pose.tip_mm.y, stock.max_mm.y);
    EXPECT_NEAR(length(pose.axis), 1.0, 1e-12);
    deepest_mm = std::max(deepest_mm, stock.max_mm.z - pose.tip_mm.z);
    if (!pose.cutting && i > 0) {
      EXPECT_GT(pose.tip_mm.z, stock.max_mm.z) << i;
    }
    if (i > 0) {
      EXPECT_GE(pose.time_s, script[i - 1].time_s);
    }
  }
  EXPECT_GT(deepest_mm, 0.0);
  EXPECT_LE(deepest_mm, size.z / 4);
}

INSTANTIATE_TEST_SUITE_P(CarvingFigure, FigureInStock,
                         ::testing::Values(StockBox{{-50, -50, -50}, {50, 50, 0}},
                                           StockBox{{0, 0, 0}, {400, 30, 12}},
                                           StockBox{{100, 100, 5}, {104, 104, 6}}));

TEST(CarvingFigure, VariantsDiffer) {
  const StockBox stock{{0, 0, 0}, {100, 100, 50}};
  const PoseScript one = make_carving_figure(stock, 1);
  const PoseScript two = make_carving_figure(stock, 2);
  EXPECT_GT(length(one[10].tip_mm - two[10].tip_mm), 1.0);
  EXPECT_EQ(one, make_carving_figure(stock, 1));
}

TEST(CarvingFigure, TiltsTheAxis) {
  double most = 0;
  for (const TimedPose& pose : make_carving_figure({{0, 0, 0}, {100, 100, 50}}, 0)) {
    most = std::max(most, std::acos(pose.axis.z));
  }
  EXPECT_GT(most, 0.3);
  EXPECT_LT(most, 0.4);
}

}  // namespace
}  // namespace kerf::agent::carving_figure_test
