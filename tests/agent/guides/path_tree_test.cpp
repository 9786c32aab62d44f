// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/guides/path_tree.h"

#include "tests/support/test.h"

namespace kerf::agent::path_tree_test {
namespace {

double distance_to(const GuidePath& path, Vec3 p) {
  double nearest = 1e300;
  for (std::size_t i = 1; i < path.size(); ++i) {
    const Vec3 from = path[i - 1].tip_mm, along = path[i].tip_mm - from;
    const double share = std::clamp(dot(p - from, along) / dot(along, along), 0.0, 1.0);
    nearest = std::min(nearest, length(p - from - along * share));
  }
  return nearest;
}

/// Rows of a raster, as in an NC program.
GuidePath raster(int rows, int columns) {
  GuidePath path;
  for (int row = 0; row < rows; ++row) {
    for (int i = 0; i < columns; ++i) {
      const int column = row % 2 == 0 ? i : columns - 1 - i;
      path.push_back({.tip_mm = {0.5 * column, 2.0 * row, std::sin(0.1 * column)}});
    }
  }
  return path;
}

TEST(PathTree, FindsTheNearestPointOfARaster) {
  const GuidePath path = raster(40, 120);
  PathTree tree({path});
  std::mt19937 random(5);
  std::uniform_real_distribution<double> x(-10, 70), y(-10, 90), z(-5, 5);
  std::size_t most = 0;
  for (int i = 0; i < 500; ++i) {
    const Vec3 tip{x(random), y(random), z(random)};
    EXPECT_NEAR(tree.nearest(tip).distance_mm, distance_to(path, tip), 1e-9);
    most = std::max(most, tree.visits());
  }
  EXPECT_LT(most, PathTree::kMostVisits) << "no query was cut short";
}

TEST(PathTree, ExaminesBoundedBoxesIfAllAreEquallyNear) {
  GuidePath circle;
  for (std::size_t i = 0; i < kGuidePosesMax; ++i) {
    const double angle = 2 * std::numbers::pi * static_cast<double>(i) / kGuidePosesMax;
    circle.push_back({.tip_mm = {30 * std::cos(angle), 30 * std::sin(angle), 0}});
  }
  PathTree tree({circle});
  for (const double off : {0.0, 1e-4, 0.01, 1.0}) {
    const GuidePoint near = tree.nearest({off, off, 0});
    EXPECT_LE(tree.visits(), PathTree::kMostVisits + 2);
    EXPECT_NEAR(near.distance_mm, 30, 0.1 + 2 * off);
  }
}

TEST(PathTree, InterpolatesAxisAndForceAlongASegment) {
  GuidePath path{{.tip_mm = {0, 0, 0}, .axis = {0, 0, 1}, .felt = {{1, 0, 0}, {}}},
                 {.tip_mm = {4, 0, 0}, .axis = {0, 1, 0}, .felt = {{3, 0, 0}, {0, 8, 0}}}};
  PathTree tree({path, {{.tip_mm = {50, 0, 0}}}});
  const GuidePoint near = tree.nearest({2, 1, 0});
  EXPECT_EQ(near.tip_mm, (Vec3{2, 0, 0}));
  EXPECT_EQ(near.tangent, (Vec3{1, 0, 0}));
  EXPECT_NEAR(near.axis.y, std::numbers::sqrt2 / 2, 1e-12);
  EXPECT_EQ(near.felt, (Wrench{{2, 0, 0}, {0, 4, 0}}));
  EXPECT_DOUBLE_EQ(near.distance_mm, 1);
  EXPECT_EQ(tree.nearest({49, 0, 0}).tip_mm, (Vec3{50, 0, 0})) << "a path of one pose";
  EXPECT_EQ(tree.segments(), 2U) << "paths are not connected";
}

}  // namespace
}  // namespace kerf::agent::path_tree_test
