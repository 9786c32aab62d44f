// SPDX-License-Identifier: Apache-2.0
#include "kernel/force/collision.h"

#include "kernel/force/signed_distance.h"
#include "kernel/sculpture.h"
#include "tests/support/test.h"

namespace kerf::collision_test {
namespace {

const Vec3 kUp{0, 0, 1};

std::vector<std::array<Vec3, 3>> box_triangles(Vec3 lo, Vec3 hi) {
  const Vec3 v[8] = {{lo.x, lo.y, lo.z}, {hi.x, lo.y, lo.z}, {hi.x, hi.y, lo.z},
                     {lo.x, hi.y, lo.z}, {lo.x, lo.y, hi.z}, {hi.x, lo.y, hi.z},
                     {hi.x, hi.y, hi.z}, {lo.x, hi.y, hi.z}};
  const int quads[6][4] = {{3, 2, 1, 0}, {4, 5, 6, 7}, {0, 1, 5, 4},
                           {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};
  std::vector<std::array<Vec3, 3>> out;
  for (const auto& q : quads) {
    out.push_back({v[q[0]], v[q[1]], v[q[2]]});
    out.push_back({v[q[0]], v[q[2]], v[q[3]]});
  }
  return out;
}

Wrench push(const Obstacle& obstacle, const ToolShape& shape, const ToolPose& pose) {
  return Obstacles({obstacle}).push(*make_tool(shape), pose, 60);
}

TEST(Collision, BallPressedIntoABoxIsPushedOutByItsDepth) {
  const Obstacle floor{BoxObstacle{{-50, -50, -10}, {50, 50, 0}}, 3};
  const Wrench w = push(floor, BallShape{10, 50}, {{2, 1, -0.25}, kUp});
  EXPECT_NEAR(w.force_n.z, 3 * 0.25, 1e-6);
  EXPECT_NEAR(length(Vec3{w.force_n.x, w.force_n.y, 0}), 0, 1e-6);
}

TEST(Collision, NoContactGivesNoForce) {
  const Obstacle floor{BoxObstacle{{-50, -50, -10}, {50, 50, 0}}, 3};
  EXPECT_EQ(push(floor, BallShape{10, 50}, {{2, 1, 0.25}, kUp}), Wrench{});
  EXPECT_EQ(push(floor, BallShape{10, 50}, {{200, 1, -5}, kUp}), Wrench{});
}

TEST(Collision, FlankAgainstAPostIsPushedSideways) {
  const Obstacle post{CylinderObstacle{{8, 0, -50}, {8, 0, 50}, 4}, 2};
  const Wrench w =
      push(post, FlatShape{10, 50}, {{0, 0, -20}, kUp});  // radii of 9 mm over a distance of 8 mm
  EXPECT_NEAR(w.force_n.x, -2 * 1.0, 1e-4);
  EXPECT_NEAR(w.force_n.y, 0, 1e-4);
}

TEST(Collision, TorqueIsArmTimesForce) {
  const Obstacle ball{SphereObstacle{{7, 0, 10}, 3}, 1};
  const Wrench w = push(ball, FlatShape{10, 50}, {{0, 0, 0}, kUp});
  EXPECT_NEAR(w.force_n.x, -1, 1e-3);
  // The contact is 10 mm up, 50 below the pivot: (x, 0, −50) × (−1, 0, 0) = (0, 50, 0).
  EXPECT_NEAR(w.torque_nmm.y, 50, 0.1);
}

TEST(Collision, TiltedFlatMillTouchesWithItsRim) {
  const Obstacle floor{BoxObstacle{{-50, -50, -10}, {50, 50, 0}}, 1};
  const Vec3 axis = normalized({0.5, 0, 1});
  const double rim_depth = 5 * axis.x;  // The rim's lowest point below the tip.
  const Wrench w = push(floor, FlatShape{10, 50}, {{0, 0, rim_depth - 0.5}, axis});
  EXPECT_NEAR(w.force_n.z, 0.5, 1e-3);
}

TEST(Collision, TiltedBullNoseTouchesWithItsCorner) {
  // Tilted by atan(1/2), the lowest point of a torus is center_r sideways and `radius` straight
  // down.
  const Obstacle floor{BoxObstacle{{-50, -50, -10}, {50, 50, 0}}, 1};
  const Vec3 axis = normalized({0.5, 0, 1});
  const double lowest = 2 * axis.z - 3 * axis.x - 2;  // The corner of radius 2 about (3, 2).
  const Wrench w = push(floor, BullNoseShape{10, 2, 50}, {{0, 0, -lowest - 0.5}, axis});
  EXPECT_NEAR(w.force_n.z, 0.5, 1e-3);
}

TEST(Collision, BarrelIsPushedAtItsGreatestRadius) {
  // A flank of radius 60, 8 mm wide at the height 20.
  const Obstacle post{CylinderObstacle{{0, -50, 20}, {0, 50, 20}, 4}, 2};
  const Wrench w = push(post, AptShape{16, 60, -52, 20, 0, 0, 20}, {{-11.5, 0, 0}, kUp});
  EXPECT_NEAR(w.force_n.x, -2 * 0.5, 1e-3);
}

TEST(Collision, ShankAndHolderCollide) {
  ToolBody body{.shank = Shank{10, 20}, .holder = std::vector<HolderSection>{{30, 30, 20}}};
  const Tool tool = *make_tool(FlatShape{4, 10}, body);
  const Obstacle post{CylinderObstacle{{8, 0, -50}, {8, 0, 25}, 4}, 2};  // Ends below the holder.
  const Wrench w = Obstacles({post}).push(tool, {{0, 0, 0}, kUp}, 60);
  EXPECT_NEAR(w.force_n.x, -2 * 1.0, 1e-4);
  const Obstacle high{SphereObstacle{{18, 0, 40}, 4}, 2};
  EXPECT_NEAR(Obstacles({high}).push(tool, {{0, 0, 0}, kUp}, 60).force_n.x, -2 * 1.0, 1e-2);
}

TEST(Collision, BoxMeshPushesLikeTheBox) {
  const Obstacle box{BoxObstacle{{-20, -20, -10}, {20, 20, 0}}, 3};
  const Obstacle mesh{MeshObstacle{box_triangles({-20, -20, -10}, {20, 20, 0})}, 3};
  const ToolPose pose{{3, 4, -0.6}, normalized({0.1, 0.2, 1})};
  const Wrench a = push(box, BallShape{10, 50}, pose), b = push(mesh, BallShape{10, 50}, pose);
  EXPECT_GT(a.force_n.z, 1);
  EXPECT_NEAR(a.force_n.z, b.force_n.z, 1e-3);
}

/// Edges of a block along y and z, as a box and as a mesh, with a flank across each. The push is
/// along the flank's normal, not along that of the face that happens to be nearer.
TEST(Collision, FlankAcrossAnEdgeIsPushedAlongItsOwnNormal) {
  const Vec3 lo{0, 0, -20}, hi{30, 30, 0};
  const Obstacle obstacles[] = {{BoxObstacle{lo, hi}, 3}, {MeshObstacle{box_triangles(lo, hi)}, 3}};
  for (const Obstacle& obstacle : obstacles) {
    for (const double lean : {0.1, 0.4, 0.8, 1.2}) {
      const Vec3 axis{std::sin(lean), 0, std::cos(lean)};
      const Vec3 normal{-std::cos(lean), 0, std::sin(lean)};
      for (const double deep_mm : {0.3, 1.0, 1.7}) {
        // The flank passes the edge at (0, 15, 0) at this depth.
        const ToolPose pose{Vec3{0, 15, 0} + normal * (5 - deep_mm) - axis * 20, axis};
        const Wrench w = push(obstacle, FlatShape{10, 50}, pose);
        EXPECT_GT(length(w.force_n), 0.6 * 3 * deep_mm);
        EXPECT_LT(length(normalized(w.force_n) - normal), 0.02) << lean << ", " << deep_mm;
      }
    }
    for (const double angle : {0.2, 0.7, 1.3}) {
      const Vec3 normal{-std::cos(angle), -std::sin(angle), 0};
      const ToolPose pose{normal * 4.2 + Vec3{0, 0, -30}, kUp};
      const Wrench w = push(obstacle, FlatShape{10, 50}, pose);
      EXPECT_LT(length(normalized(w.force_n) - normal), 0.1) << angle;
    }
  }
}

/// Both ends of a thin flange are near its deepest point, which is on its upper side here.
TEST(Collision, ThinFlangeIsPushedFromTheTouchingSide) {
  const Obstacle box{BoxObstacle{{0, -50, 0}, {30, 50, 30}}, 3};
  const double thick_mm = 0.04, deep_mm = 0.5;
  const ProfileShape flange{{ProfilePoint{5, 0}, ProfilePoint{5, thick_mm},
                             ProfilePoint{0.5, thick_mm}, ProfilePoint{0.5, 2}}};
  for (const double lean : {0.5, 0.7, 0.8}) {
    const Vec3 axis{std::sin(lean), 0, std::cos(lean)}, aside{axis.z, 0, -axis.x};
    // The edge of the box is 3.5 mm from the axis.
    const ToolPose pose{aside * -3.5 + axis * (deep_mm - thick_mm), axis};
    const Wrench w = push(box, flange, pose);
    ASSERT_GT(length(w.force_n), 0.3);
    EXPECT_LT(length(normalized(w.force_n) + axis), 1e-6) << lean;
  }
}

TEST(Collision, MeshWithTooManyTrianglesIsRejected) {
  const std::vector<std::array<Vec3, 3>> many(200'001,
                                              {Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{0, 1, 0}});
  EXPECT_FALSE(check_obstacle({MeshObstacle{many}, 1}).empty());
}

TEST(SignedDistance, CylinderInsideAndOut) {
  const CylinderObstacle c{{0, 0, 0}, {0, 0, 10}, 2};
  EXPECT_NEAR(signed_distance(c, {5, 0, 5}).distance_mm, 3, 1e-12);
  EXPECT_NEAR(signed_distance(c, {0, 0, 13}).distance_mm, 3, 1e-12);
  EXPECT_NEAR(signed_distance(c, {5, 0, 14}).distance_mm, 5, 1e-12);
  EXPECT_NEAR(signed_distance(c, {1.5, 0, 5}).distance_mm, -0.5, 1e-12);
}

TEST(Collision, IsAddedToTheCuttingForceOfAMotion) {
  SculptureSettings settings;
  settings.stock = BoxStock{{-20, -20, -20}, {20, 20, 0}};
  settings.obstacles = {{BoxObstacle{{-20, -20, -30}, {20, 20, -19}}, 5}};
  auto s = *Sculpture::create(settings);
  s.apply(DefineTool{1, *make_tool(BallShape{10, 50})}).value();
  const auto r = s.apply(MoveTool{1, {{0, 0, -18}, kUp}, {{0, 0, -19.5}, kUp}, 0.01}).value();
  EXPECT_NEAR(r.collision.force_n.z, 5 * 0.5, 1e-6);
  EXPECT_GT(r.wrench.force_n.z, r.collision.force_n.z);
}

}  // namespace
}  // namespace kerf::collision_test
