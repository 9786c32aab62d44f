// SPDX-License-Identifier: Apache-2.0
#include "kernel/piece/ball.h"

#include "tests/kernel/piece/piece_support.h"
#include "tests/support/test.h"

namespace kerf::ball_test {
namespace {

TEST(BallPiece, RadiusSlopeExtentAndDistanceAreThoseOfACircle) {
  const BallPiece p{7, 5};
  EXPECT_EQ(extent(p).z0_mm, 2);
  EXPECT_EQ(extent(p).z1_mm, 12);
  EXPECT_EQ(extent(p).radius_mm, 5);
  EXPECT_EQ(radius_at(p, 7.0), 5);
  EXPECT_DOUBLE_EQ(radius_at(p, 4.0), 4);
  EXPECT_EQ(radius_at(p, 1.99), kNoRadiusMm);
  EXPECT_EQ(radius_at(p, 12.01), kNoRadiusMm);
  EXPECT_EQ(slope_at(p, 7.0), 0);
  EXPECT_DOUBLE_EQ(slope_at(p, 4.0), 0.75);
  const auto outside = side_distance(p, 6.0, 15.0);
  EXPECT_EQ(outside.mm, 5);
  EXPECT_EQ(outside.across / outside.length, 0.6);
  EXPECT_EQ(outside.along / outside.length, 0.8);
  EXPECT_EQ(side_distance(p, 0.0, 7.0).mm, -5);
}

TEST(BallPiece, MatchesBruteForce) {
  std::mt19937 random(11);
  for (int n = 0; n < 200; ++n) {
    const BallPiece p{test::between(random, 0, 20), test::between(random, 0.1, 10)};
    const auto inside = [&](test::HalfPoint q) {
      return q.rho * q.rho + (q.h - p.center_mm) * (q.h - p.center_mm) <= p.radius_mm * p.radius_mm;
    };
    std::vector<test::HalfPoint> outline;
    for (int k = 0; k <= 2000; ++k) {
      const double a = std::numbers::pi * k / 2000;
      outline.push_back({p.radius_mm * std::sin(a), p.center_mm - p.radius_mm * std::cos(a)});
    }
    for (int k = 0; k < 20; ++k) {
      const double h = p.center_mm + p.radius_mm * test::between(random, -0.99, 0.99);
      EXPECT_NEAR(radius_at(p, h), test::radius_by_bisection(inside, h, 20), 1e-9 * p.radius_mm);
      const double step = 1e-6 * p.radius_mm;
      EXPECT_NEAR(slope_at(p, h), (radius_at(p, h + step) - radius_at(p, h - step)) / (2 * step),
                  1e-3);
      const test::HalfPoint q{test::between(random, 0, 2 * p.radius_mm), h};
      const double sign = inside(q) ? -1 : 1;
      EXPECT_NEAR(side_distance(p, q.rho, q.h).mm, sign * test::nearest_of(outline, q),
                  1e-3 * p.radius_mm);
    }
  }
}

TEST(BallPiece, LanesGiveTheBitsOfScalars) {
  const BallPiece p{7, 5};
  const double heights[] = {1, 2, 2.5, 4, 7, 9.125, 12, 13};
  EXPECT_TRUE(test::lanes_match_scalars(
      heights, [&](Lanes z) { return radius_at(p, z); },
      [&](double z) { return radius_at(p, z); }));
  EXPECT_TRUE(test::lanes_match_scalars(
      heights, [&](Lanes z) { return slope_at(p, z); }, [&](double z) { return slope_at(p, z); }));
  EXPECT_TRUE(test::lanes_match_scalars(
      heights, [&](Lanes z) { return side_distance(p, Lanes(3), z).mm; },
      [&](double z) { return side_distance(p, 3.0, z).mm; }));
}

}  // namespace
}  // namespace kerf::ball_test
