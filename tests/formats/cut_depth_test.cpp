// SPDX-License-Identifier: Apache-2.0
#include "server/verify/cut_depth.h"

#include "kernel/sculpture.h"
#include "server/formats/model/indexed_mesh.h"
#include "server/verify/convex_outline.h"
#include "tests/support/carvings.h"
#include "tests/support/test.h"

namespace kerf::cut_depth_test {
namespace {

constexpr double kPitchMm = 0.5;
/// The deepest sample is found to a tenth of a pitch; numbers are rounded.
constexpr double kFoundMm = 0.1 * kPitchMm, kRoundingMm = 1e-6;
const Vec3 kUp{0, 0, 1};

class CutDepthTest : public testing::Test {
 protected:
  CutDepthTest() {
    define(1, FlatShape{.diameter_mm = 6, .length_mm = 30});
    define(2, BallShape{.diameter_mm = 6, .length_mm = 30});
  }

  void cut(ToolId tool, const ToolPose& from, const ToolPose& to) {
    block_.apply(MoveTool{tool, from, to, 1, false}).value();
  }
  /// Cuts and returns the depth of the cut.
  double depth(ToolId tool, const ToolPose& from, const ToolPose& to, double ignored_mm = 0) {
    const DexelSnapshot before = block_.snapshot();
    const auto done = block_.apply(MoveTool{tool, from, to, 1, false}).value();
    CutDepth found(*block_.tool(tool), from, to, ignored_mm, before, block_.snapshot(),
                   done.cut_tiles);
    while (!found.advance(100)) {
    }
    return found.depth_mm();
  }

  Sculpture block_ = test::make_sculpture(BoxStock{{0, 0, -20}, {40, 30, 0}}, kPitchMm);

 private:
  void define(ToolId id, const ToolShape& shape) {
    block_.apply(DefineTool{id, make_tool(shape).value()}).value();
  }
};

TEST_F(CutDepthTest, AMotionOutsideOfTheStockHasNone) {
  EXPECT_EQ(depth(1, {{0, 15, 1}, kUp}, {{40, 15, 1}, kUp}), 0);
}

TEST_F(CutDepthTest, ASlotIsAsDeepAsTheToolIsBelowTheTop) {
  double y_mm = 5;
  for (const double deep_mm : {1.9, 0.4, 1.3}) {
    const double found_mm = depth(1, {{-5, y_mm, -deep_mm}, kUp}, {{45, y_mm, -deep_mm}, kUp});
    EXPECT_GE(found_mm, deep_mm - kFoundMm);
    EXPECT_LE(found_mm, deep_mm + kRoundingMm);
    y_mm += 8.1;
  }
}

/// Inside the tool the nearest surface of the sweep is its side.
TEST_F(CutDepthTest, ADeepSlotIsHalfAsDeepAsItIsWide) {
  const double found_mm = depth(1, {{-5, 15, -10}, kUp}, {{45, 15, -10}, kUp});
  EXPECT_GE(found_mm, 3 - kPitchMm);
  EXPECT_LE(found_mm, 3);
}

/// The removed volume is 0.4 mm * 20 mm * 40 mm, as much as that of a plunge of 11 mm.
TEST_F(CutDepthTest, AlongAWallOnlyTheThicknessCounts) {
  cut(1, {{-5, 15, -20}, kUp}, {{45, 15, -20}, kUp});
  const double found_mm = depth(1, {{-5, 15.4, -20}, kUp}, {{45, 15.4, -20}, kUp});
  EXPECT_GE(found_mm, 0.1);
  EXPECT_LE(found_mm, 0.4 + kRoundingMm);
}

TEST_F(CutDepthTest, BackAlongItsOwnPathAToolHasNone) {
  const ToolPose from{{5, 15, -2}, kUp}, to{{35, 20, -3}, normalized({0.2, 0, 1})};
  cut(2, from, to);
  EXPECT_LE(depth(2, to, from), block_.settings().tolerance_mm);
  cut(1, {{5, 5, -2}, kUp}, {{35, 5, -3}, kUp});
  EXPECT_LE(depth(1, {{35, 5, -3}, kUp}, {{5, 5, -2}, kUp}), 1e-6);
}

/// A column that is removed whole has no end on the surface of the sweep, so it may be deeper than
/// it is long.
TEST_F(CutDepthTest, APlateThatIsCutThroughCountsFromTheBottomOfTheTool) {
  block_ = test::make_sculpture(BoxStock{{0, 0, -2}, {40, 30, 0}}, kPitchMm);
  block_.apply(DefineTool{1, make_tool(FlatShape{.diameter_mm = 6, .length_mm = 30}).value()})
      .value();
  const double found_mm = depth(1, {{-5, 15, -2.5}, kUp}, {{45, 15, -2.5}, kUp}, 2.2);
  EXPECT_GE(found_mm, 2.5 - kPitchMm / 2);
  EXPECT_LE(found_mm, 2.5 + kRoundingMm);
}

TEST_F(CutDepthTest, OnlyColumnsInAnOutlineCount) {
  IndexedMesh triangle{.origin_mm = {10, 0, 0},
                       .positions_mm = {{0, 0, 0}, {20, 0, 5}, {10, 3, 0}, {0, 20, 0}},
                       .triangles = {{0, 1, 3}}};
  const ConvexOutline outline(triangle);
  EXPECT_TRUE(outline.contains(10, 20));
  EXPECT_TRUE(outline.contains(19, 10));
  EXPECT_FALSE(outline.contains(21, 10));
  EXPECT_FALSE(outline.contains(9.9, 5));
  const auto depth_at = [&](Vec3 tip) {
    const ToolPose pose{tip, kUp};
    const DexelSnapshot before = block_.snapshot();
    const auto done = block_.apply(MoveTool{1, pose, pose, 1, false}).value();
    CutDepth found(*block_.tool(1), pose, pose, 0, before, block_.snapshot(), done.cut_tiles,
                   &outline);
    EXPECT_TRUE(found.advance(1'000'000));
    return found.depth_mm();
  };
  EXPECT_EQ(depth_at({5, 10, -2}), 0);
  EXPECT_EQ(depth_at({28, 20, -2}), 0);
  EXPECT_GE(depth_at({15, 8, -2}), 2 - kFoundMm);
}

/// The greatest depth of the points that a motion has removed, in steps of a quarter pitch.
double dense_depth(const MovingTool& moving, const DexelSnapshot& before,
                   const DexelSnapshot& after) {
  double deepest_mm = 0;
  std::vector<Dexel> a, b;
  const DexelGrid& grid = after.grid();
  const auto follow = [&](std::int32_t i, std::int32_t j, const Dexel& d) {
    const std::span<const Dexel> left = after.column(i, j, b);
    for (double z = grid.z_mm(d.bottom); z <= grid.z_mm(d.top); z += kPitchMm / 4) {
      const auto contains = [&](const Dexel& e) {
        return grid.z_mm(e.bottom) <= z && z <= grid.z_mm(e.top);
      };
      if (std::ranges::any_of(left, contains)) continue;
      const Vec3 point{grid.x_mm(i), grid.y_mm(j), z};
      deepest_mm = std::max(deepest_mm, -nearest_pose(moving, point, {0, 1e9}, -1e9).mm);
    }
  };
  for (std::int32_t j = 0; j < grid.columns_y; ++j) {
    for (std::int32_t i = 0; i < grid.columns_x; ++i) {
      if (std::ranges::equal(before.column(i, j, a), after.column(i, j, b))) continue;
      for (const Dexel& d : before.column(i, j, a)) follow(i, j, d);
    }
  }
  return deepest_mm;
}

TEST_F(CutDepthTest, EqualsADenseSearchForRandomMotions) {
  std::mt19937 random(11);
  const auto uniform = [&](double low, double high) {
    return low + (high - low) * (static_cast<double>(random()) / 4294967296.0);
  };
  for (int n = 0; n < 12; ++n) {
    const auto pose = [&] {
      return ToolPose{{uniform(5, 35), uniform(5, 25), uniform(-4, 0)},
                      normalized({uniform(-0.3, 0.3), uniform(-0.3, 0.3), 1})};
    };
    const auto tool = static_cast<ToolId>(1 + n % 2);
    const ToolPose from = pose();
    ToolPose to = pose();
    if (n % 3 != 0) to.axis = from.axis;
    const DexelSnapshot before = block_.snapshot();
    const double found_mm = depth(tool, from, to);
    const ToolProfile profile(*block_.tool(tool));
    const MovingTool moving{&profile, from, to, std::acos(std::min(1.0, dot(from.axis, to.axis))),
                            length(to.tip_mm - from.tip_mm)};
    const double dense_mm = dense_depth(moving, before, block_.snapshot());
    EXPECT_GE(found_mm, dense_mm - kPitchMm / 4 - kFoundMm) << n;
    EXPECT_LE(found_mm, dense_mm + kPitchMm / 8) << n;
  }
}

}  // namespace
}  // namespace kerf::cut_depth_test
