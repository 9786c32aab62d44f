#include <gtest/gtest.h>

#include <cmath>

#include "kernel/intersect/ray_cone.h"
#include "kernel/intersect/ray_cylinder.h"
#include "kernel/intersect/ray_parallelogram.h"
#include "kernel/intersect/ray_pipe.h"
#include "kernel/intersect/ray_sphere.h"

namespace kerf {
namespace {

template <class Primitive>
Span hit(const Primitive& primitive, double x, double y) {
  Span span;
  primitive.extend(span, x, y);
  return span;
}

bool misses(const Span& s) { return s.lo > s.hi; }

TEST(RaySphere, EntersAndLeavesAtTheSphere) {
  const Span s = hit(RaySphere{{1, 2, 3}, 25}, 4, 2);
  EXPECT_DOUBLE_EQ(s.lo, 3 - 4);
  EXPECT_DOUBLE_EQ(s.hi, 3 + 4);
  EXPECT_TRUE(misses(hit(RaySphere{{1, 2, 3}, 25}, 6.0001, 2)));
  const Span tangent = hit(RaySphere{{1, 2, 3}, 25}, 6, 2);
  EXPECT_DOUBLE_EQ(tangent.lo, 3);
  EXPECT_DOUBLE_EQ(tangent.hi, 3);
}

TEST(RayCylinder, HorizontalCylinderIsACircleAcross) {
  const RayCylinder c({0, 0, 10}, {8, 0, 0}, 5);
  const Span s = hit(c, 4, 3);
  EXPECT_DOUBLE_EQ(s.lo, 6);
  EXPECT_DOUBLE_EQ(s.hi, 14);
  EXPECT_TRUE(misses(hit(c, -0.1, 3)));
  EXPECT_TRUE(misses(hit(c, 8.1, 3)));
  EXPECT_TRUE(misses(hit(c, 4, 5.001)));
}

TEST(RayCylinder, VerticalCylinderHasNoEndOnTheRay) {
  EXPECT_TRUE(misses(hit(RayCylinder({0, 0, 0}, {0, 0, 9}, 5), 1, 1)));
}

TEST(RayCone, UprightCylinderEndsAtItsDiscs) {
  const RayCone c({0, 0, 2}, {0, 0, 1}, 30, 5, 5);
  const Span s = hit(c, 3, 3.9);
  EXPECT_DOUBLE_EQ(s.lo, 2);
  EXPECT_DOUBLE_EQ(s.hi, 32);
  EXPECT_TRUE(misses(hit(c, 3, 4.1)));
}

TEST(RayCone, UprightConeStartsOnItsSide) {
  const Span s = hit(RayCone({0, 0, 0}, {0, 0, 1}, 10, 0, 10), 3, 4);
  EXPECT_DOUBLE_EQ(s.lo, 5);
  EXPECT_DOUBLE_EQ(s.hi, 10);
}

TEST(RayCone, LyingCylinderIsMetAcross) {
  const Span s = hit(RayCone({0, 0, 0}, {1, 0, 0}, 20, 5, 5), 7, 4);
  EXPECT_DOUBLE_EQ(s.lo, -3);
  EXPECT_DOUBLE_EQ(s.hi, 3);
}

TEST(RayCone, RayParallelToAGeneratorStillEnters) {
  // Half angle 45 degrees, leaning by 45 degrees: the quadratic's leading coefficient is exactly
  // zero.
  const double h = std::sqrt(0.5);
  const RayCone c({0, 0, 0}, {h, 0, h}, 10, 0, 10);
  const Span s = hit(c, 2, 1);
  ASSERT_FALSE(misses(s));
  // On the cone, (x + z)^2 / 2 = (z - x)^2 / 2 + y^2, so z = y^2 / (2 x).
  EXPECT_NEAR(s.lo, 1.0 / 4, 1e-12);
}

TEST(RayParallelogram, IsMetWithinItsBordersOnly) {
  const RayParallelogram p({0, 0, 1}, {4, 0, 4}, {0, 2, 2});
  const Span s = hit(p, 1, 1);
  EXPECT_DOUBLE_EQ(s.lo, 1 + 1 + 1);
  EXPECT_DOUBLE_EQ(s.hi, s.lo);
  EXPECT_TRUE(misses(hit(p, 4.1, 1)));
  EXPECT_TRUE(misses(hit(p, 1, -0.1)));
}

TEST(RayParallelogram, UprightOneIsMetNowhere) {
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

TEST(RayPipe, SlantedMotionMeetsThePaper) {
  // Circle in the XY plane (normal Z) moved by (4, 0, 2): at height w its centre is at x = 2 w (Eq.
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
  // Vz = 0, where Eq. 17 divides by zero: the circle stays in its plane, so whatever is met lies in
  // that plane.
  const RayPipe p({0, 0, 7}, {0, 0, 1}, 3, {10, 0, 0});
  const Span s = hit(p, 5, 1);
  EXPECT_DOUBLE_EQ(s.lo, 7);
  EXPECT_DOUBLE_EQ(s.hi, 7);
}

TEST(RayPipe, CircleMovedAlongTheRayBoundsNothing) {
  EXPECT_TRUE(misses(hit(RayPipe({0, 0, 0}, {0, 0, 1}, 3, {0, 0, 10}), 1, 1)));
}

}  // namespace
}  // namespace kerf
