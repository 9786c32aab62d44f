// SPDX-License-Identifier: Apache-2.0
#include "kernel/force/contact_patch.h"

#include "kernel/sculpture.h"
#include "tests/support/test.h"

namespace kerf::contact_patch_test {
namespace {

const Vec3 kUp{0, 0, 1};

/// Returns a block with its top at z = 0, as stock or as an obstacle, and a tool 1.
Sculpture block(const ToolShape& shape, bool obstacle) {
  SculptureSettings settings;
  settings.stock =
      obstacle ? BoxStock{{-20, -20, -40}, {20, 20, -30}} : BoxStock{{-20, -20, -20}, {20, 20, 0}};
  if (obstacle) settings.obstacles = {{BoxObstacle{{-20, -20, -20}, {20, 20, 0}}, 1}};
  settings.pitch_mm = 0.25;
  auto s = *Sculpture::create(settings);
  s.apply(DefineTool{1, *make_tool(shape)}).value();
  return s;
}

ContactPlane only_plane(const Sculpture& s, const ToolPose& pose) {
  std::vector<ContactPlane> planes = s.contact(1, pose, false);
  std::erase_if(planes, [](const ContactPlane& p) { return !(p.depth_mm > 0); });
  EXPECT_EQ(planes.size(), 1U);
  return planes.empty() ? ContactPlane{} : planes.front();
}

TEST(PatchSum, HalfAxesAreTwoStandardDeviationsWithinThePlane) {
  // Far from the origin, where sums of squares lose digits.
  const Vec3 center{1000, -2000, 500};
  const Vec3 u = normalized({3, 4, 0}), v{-u.y, u.x, 0};
  PatchSum sum;
  for (const double side : {-1.0, 1.0}) {
    sum.add(center + u * (3 * side), 2);
    sum.add(center + v * side + kUp * (7 * side), 2);
  }
  ContactPlane plane{.normal = kUp};
  sum.place(plane);
  EXPECT_NEAR(length(plane.point_mm - center), 0, 1e-9);
  EXPECT_NEAR(std::abs(dot(plane.half_a_mm, u)), 2 * 3 / std::sqrt(2), 1e-9);
  EXPECT_NEAR(std::abs(dot(plane.half_b_mm, v)), 2 * 1 / std::sqrt(2), 1e-9);
  EXPECT_NEAR(dot(plane.half_a_mm, v), 0, 1e-9);
}

TEST(ContactPatch, FlatToolsTouchWithADiscAndBallsWithAPoint) {
  for (const bool obstacle : {false, true}) {
    const ContactPlane flat = only_plane(block(FlatShape{12, 40}, obstacle), {{0, 0, -0.5}, kUp});
    EXPECT_NEAR(length(flat.half_a_mm), 6, 0.6) << "a disc's springs stand at its rim";
    EXPECT_NEAR(length(flat.half_b_mm), 6, 0.6);
    EXPECT_NEAR(dot(flat.half_a_mm, flat.half_b_mm), 0, 1e-9);
    EXPECT_NEAR(flat.point_mm.x, 0, 0.1);
  }
  for (const bool obstacle : {false, true}) {
    const ContactPlane ball = only_plane(block(BallShape{12, 40}, obstacle), {{0, 0, -0.5}, kUp});
    EXPECT_EQ(ball.half_a_mm, Vec3{});
  }
}

TEST(ContactPatch, SpreadKeepsTheWrenchAndResistsTurning) {
  const ToolPose pose{{0, 0, -0.5}, normalized({0.01, 0.02, 1})};
  for (const bool obstacle : {false, true}) {
    const ContactPlane plane = only_plane(block(FlatShape{12, 40}, obstacle), pose);
    const std::vector<ContactPlane> points = spread({&plane, 1}, 8);
    ASSERT_EQ(points.size(), 3U);
    const Wrench whole = wrench_of({&plane, 1}, pose, 60), sum = wrench_of(points, pose, 60);
    EXPECT_NEAR(length(whole.force_n - sum.force_n), 0, 1e-9);
    EXPECT_NEAR(length(whole.torque_nmm - sum.torque_nmm), 0, 1e-9);
    EXPECT_FALSE(points[0].continues);
    EXPECT_TRUE(points[1].continues && points[2].continues);
    // About any axis in the face: the springs' second moment, k R²/2 with R = 6.
    for (const Vec3 about : {Vec3{1, 0, 0}, Vec3{0.6, 0.8, 0}}) {
      double resists = 0;
      for (const ContactPlane& p : points) {
        const double lever = cross(about, p.point_mm - plane.point_mm).z;
        resists += p.stiffness_n_per_mm * lever * lever;
      }
      EXPECT_NEAR(resists, 18, 4) << obstacle;
    }
  }
}

TEST(ContactPatch, SpreadReplacesTheDeepestUpToTheLimit) {
  ContactPlane wide{{}, kUp, 1, 3};
  wide.half_a_mm = {2, 0, 0};
  wide.half_b_mm = {0, 2, 0};
  ContactPlane line = wide;
  line.half_b_mm = {};
  ContactPlane gap = wide;
  gap.depth_mm = -1;
  EXPECT_EQ(spread(std::vector{wide, line, gap}, 8).size(), 3U + 2 + 1);
  EXPECT_EQ(spread(std::vector{wide, wide, wide}, 8).size(), 3U + 3 + 1);
  EXPECT_EQ(spread(std::vector(9, wide), 8).size(), 8U);
}

}  // namespace
}  // namespace kerf::contact_patch_test
