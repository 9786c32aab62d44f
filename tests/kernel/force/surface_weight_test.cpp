// SPDX-License-Identifier: Apache-2.0
// The weight of a removed element in a field: the squared normal component along the field's rays.

#include "kernel/force/surface_weight.h"

#include "kernel/math/ray_axis.h"
#include "tests/support/test.h"

namespace kerf::surface_weight_test {
namespace {

const Vec3 kUp{0, 0, 1};

double weight_at(const SurfaceWeight& surface, Vec3 p, Vec3 axis) {
  const GroupPoints points{Lanes(p.x), p.y, Lanes(p.z)};
  Lanes weight;
  surface.evaluate(points, axis, weight);
  for (int c = 0; c < kLanes; ++c) EXPECT_EQ(weight[c], weight[0]);
  return weight[0];
}

TEST(SurfaceWeight, BallWeightIsTheSquaredNormalComponent) {
  const SurfaceWeight surface(*make_tool(BallShape{10, 50}));
  const Vec3 n = normalized({0.3, -0.5, -0.7});
  for (const double out : {-0.05, 0.0, 0.05}) {
    EXPECT_NEAR(weight_at(surface, Vec3{0, 0, 5} + n * (5 + out), kUp), n.z * n.z, 1e-12);
  }
  // The wall begins just above the ball's equator; the seam between the pieces is not a surface.
  EXPECT_NEAR(weight_at(surface, {4.99, 0, 5.005}, kUp), 0, 1e-4);
  EXPECT_NEAR(weight_at(surface, {0, 5, 20}, kUp), 0, 1e-12);
}

TEST(SurfaceWeight, FlatMillWeightIsOneOnTheFloorAndZeroOnTheWall) {
  const SurfaceWeight surface(*make_tool(FlatShape{10, 50}));
  EXPECT_NEAR(weight_at(surface, {1, 2, -0.01}, kUp), 1, 1e-12);
  EXPECT_NEAR(weight_at(surface, {3, 4.01, 2}, kUp), 0, 1e-12);
  // Horizontal, along X: the weight of the wall depends on the angle around the axis.
  EXPECT_NEAR(weight_at(surface, {20, 3, 4}, {1, 0, 0}), 16.0 / 25, 1e-12);
  EXPECT_NEAR(weight_at(surface, {-0.01, 1, 1}, {1, 0, 0}), 0, 1e-12);
}

TEST(SurfaceWeight, CornerAndConeWeightsFollowTheirNormals) {
  // A corner of radius 1 around (4, 1) between the floor and the wall.
  const SurfaceWeight bull(*make_tool(BullNoseShape{10, 1, 50}));
  const double s = std::numbers::sqrt2 / 2;
  EXPECT_NEAR(weight_at(bull, {4 + s, 0, 1 - s}, kUp), 0.5, 1e-12);
  EXPECT_NEAR(weight_at(bull, {2, 0, -0.01}, kUp), 1, 1e-12);
  EXPECT_NEAR(weight_at(bull, {5.01, 0, 9}, kUp), 0, 1e-12);
  // A cone of 60 degrees at the tip: its wall is 30 degrees from the axis.
  const SurfaceWeight cone(*make_tool(ConeEndShape{10, 60, 50}));
  EXPECT_NEAR(weight_at(cone, {2 * std::tan(std::numbers::pi / 6), 0, 2}, kUp), 0.25, 1e-12);
}

TEST(SurfaceWeight, ThreeFieldsAddUpToOne) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> unit(-1, 1);
  const std::array shapes{ToolShape{BallShape{10, 50}}, ToolShape{FlatShape{10, 50}},
                          ToolShape{TaperShape{6, 10, 50}}, ToolShape{ConeEndShape{10, 90, 50}},
                          ToolShape{BullNoseShape{10, 1, 50}}};
  for (const ToolShape& shape : shapes) {
    const SurfaceWeight surface(*make_tool(shape));
    for (int k = 0; k < 2000; ++k) {
      const Vec3 axis = normalized({unit(random), unit(random), unit(random) + 1.01});
      const Vec3 p{unit(random) * 8, unit(random) * 8, unit(random) * 8};
      double sum = 0;
      for (const RayAxis rays : {RayAxis::kX, RayAxis::kY, RayAxis::kZ}) {
        sum += weight_at(surface, to_frame(rays, p), to_frame(rays, axis));
      }
      ASSERT_NEAR(sum, 1, 1e-9);
    }
  }
}

}  // namespace
}  // namespace kerf::surface_weight_test
