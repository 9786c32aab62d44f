// SPDX-License-Identifier: Apache-2.0
#include "kernel/intersect/ray_capsule.h"
#include "kernel/intersect/ray_parallelogram.h"
#include "kernel/intersect/ray_pipe.h"
#include "tests/support/test.h"

namespace kerf::ray_primitives_test {
namespace {

template <class Primitive>
Span hit(const Primitive& primitive, double x, double y) {
  Span span;
  primitive.extend(span, x, y);
  return span;
}

bool misses(const Span& s) { return s.lo > s.hi; }

TEST(RayCapsule, AtRestIsASphere) {
  const RayCapsule c({1, 2, 3}, {1, 2, 3}, 5);
  const Span s = hit(c, 4, 2);
  EXPECT_DOUBLE_EQ(s.lo, 3 - 4);
  EXPECT_DOUBLE_EQ(s.hi, 3 + 4);
  EXPECT_TRUE(misses(hit(c, 6.0001, 2)));
  const Span tangent = hit(c, 6, 2);
  EXPECT_DOUBLE_EQ(tangent.lo, 3);
  EXPECT_DOUBLE_EQ(tangent.hi, 3);
}

TEST(RayCapsule, HorizontalMotionGivesACircularCrossSection) {
  const RayCapsule c({0, 0, 10}, {8, 0, 10}, 5);
  const Span s = hit(c, 4, 3);
  EXPECT_DOUBLE_EQ(s.lo, 6);
  EXPECT_DOUBLE_EQ(s.hi, 14);
  EXPECT_DOUBLE_EQ(hit(c, -3, 0).lo, 6);
  EXPECT_DOUBLE_EQ(hit(c, 11, 0).lo, 6);
  EXPECT_TRUE(misses(hit(c, -5.001, 0)));
  EXPECT_TRUE(misses(hit(c, 4, 5.001)));
}

TEST(RayCapsule, PlungeSpansFromTheLowerToTheUpperBall) {
  for (const double travel : {9.0, -9.0}) {
    const Span s = hit(RayCapsule({0, 0, 0}, {0, 0, travel}, 5), 0, 3);
    EXPECT_DOUBLE_EQ(s.lo, std::min(travel, 0.0) - 4);
    EXPECT_DOUBLE_EQ(s.hi, std::max(travel, 0.0) + 4);
  }
}

TEST(RayCapsule, RampIsBoundedByTheSlantedCylinder) {
  // At 45 degrees the cylinder of radius 5 is an ellipse of half-height 5 √2 on the ray.
  const Span s = hit(RayCapsule({-20, 0, -20}, {20, 0, 20}, 5), 0, 0);
  EXPECT_NEAR(s.lo, -5 * std::sqrt(2), 1e-12);
  EXPECT_NEAR(s.hi, 5 * std::sqrt(2), 1e-12);
}

TEST(RayCapsule, EndOfAMotionAndStartOfTheNextGiveTheSameBits) {
  const Vec3 a{0.1, 0.2, 7}, b{1.3, -0.7, 7.9}, c{2.9, 0.3, 7.1};
  const RayCapsule before(a, b, 5), after(b, c, 5);
  // Before the joint the second motion is bounded by the ball at b, beyond it the first one is.
  const auto ball = hit(RayCapsule(b, b, 5), 1.31, -4.1);
  for (const RayCapsule& capsule : {before, after}) {
    const Span s = hit(capsule, 1.31, -4.1);
    EXPECT_LE(s.lo, ball.lo);
    EXPECT_GE(s.hi, ball.hi);
  }
}

TEST(RayParallelogram, IsHitWithinItsBordersOnly) {
  const RayParallelogram p({0, 0, 1}, {4, 0, 4}, {0, 2, 2});
  const Span s = hit(p, 1, 1);
  EXPECT_DOUBLE_EQ(s.lo, 1 + 1 + 1);
  EXPECT_DOUBLE_EQ(s.hi, s.lo);
  EXPECT_TRUE(misses(hit(p, 4.1, 1)));
  EXPECT_TRUE(misses(hit(p, 1, -0.1)));
}

TEST(RayParallelogram, ParallelToTheRayIsNeverHit) {
  EXPECT_TRUE(misses(hit(RayParallelogram({0, 0, 0}, {0, 0, 5}, {3, 0, 0}), 1, 0)));
}

TEST(RayPipe, CircleMovedAlongItsNormalIsACylinder) {
  // A circle in the YZ plane moved along X.
  const RayPipe p({0, 0, 10}, {1, 0, 0}, 5, {8, 0, 0});
  const Span s = hit(p, 4, 3);
  EXPECT_DOUBLE_EQ(s.lo, 6);
  EXPECT_DOUBLE_EQ(s.hi, 14);
  EXPECT_TRUE(misses(hit(p, 8.5, 3)));
}

TEST(RayPipe, SlantedMotionMatchesEquation17) {
  // Circle in the XY plane (normal Z) moved by (4, 0, 2): at height w its center is at x = 2 w (Eq.
  // 17 with Vx / Vz = 2).
  const RayPipe p({0, 0, 0}, {0, 0, 1}, 3, {4, 0, 2});
  const double half = std::sqrt(9.0 - 1.0);
  // The circle's rear passes x = 2.5 after its end, its front before its start.
  EXPECT_TRUE(misses(hit(p, 2.5, 1)));
  EXPECT_TRUE(misses(hit(p, 2.5, 3.1)));
  const Span leaving = hit(p, 4, 1);
  EXPECT_NEAR(leaving.lo, (4 - half) / 2, 1e-12);
}

TEST(RayPipe, HorizontalSweepHasNoPipeSurface) {
  // Vz = 0, where Eq. 17 divides by zero: the circle stays in its plane, so every hit is in that
  // plane.
  const RayPipe p({0, 0, 7}, {0, 0, 1}, 3, {10, 0, 0});
  const Span s = hit(p, 5, 1);
  EXPECT_DOUBLE_EQ(s.lo, 7);
  EXPECT_DOUBLE_EQ(s.hi, 7);
}

TEST(RayPipe, CircleMovedAlongTheRayBoundsNothing) {
  EXPECT_TRUE(misses(hit(RayPipe({0, 0, 0}, {0, 0, 1}, 3, {0, 0, 10}), 1, 1)));
}

}  // namespace
}  // namespace kerf::ray_primitives_test
