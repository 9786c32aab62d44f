// SPDX-License-Identifier: Apache-2.0
#include "kernel/piece/arc.h"

#include "tests/kernel/piece/piece_support.h"
#include "tests/support/test.h"

namespace kerf::arc_test {
namespace {

TEST(ArcPiece, CornerOfABullNose) {
  const ArcPiece p{4, 1, 1, 0, 1};
  EXPECT_EQ(radius_at(p, 0.0), 4);
  EXPECT_EQ(radius_at(p, 1.0), 5);
  EXPECT_DOUBLE_EQ(radius_at(p, 0.4), 4.8);
  EXPECT_EQ(radius_at(p, 1.001), kNoRadiusMm);
  EXPECT_DOUBLE_EQ(slope_at(p, 0.4), 0.75);
  EXPECT_EQ(extent(p).radius_mm, 5);
  // Below the circle's center and nearer to the axis than it: the distance is that from the flat
  // bottom.
  EXPECT_EQ(side_distance(p, 7.0, 1.0).mm, 2);
  EXPECT_EQ(side_distance(p, 2.0, -3.0).mm, 3);
  EXPECT_EQ(side_distance(p, 2.0, -3.0).across, 0);
}

TEST(ArcPiece, IsLevelWhereItEndsAcrossTheAxis) {
  const ArcPiece lower{4, 1, 1, 0, 1}, upper{4, 1, 1, 1, 2}, whole{4, 1, 1, 0, 2};
  EXPECT_TRUE(is_level_below(lower));
  EXPECT_FALSE(is_level_above(lower));
  EXPECT_FALSE(is_level_below(upper));
  EXPECT_TRUE(is_level_above(upper));
  EXPECT_TRUE(is_level_below(whole) && is_level_above(whole));
  // A slice that ends earlier, on either side.
  const ArcPiece slice{4, 1, 1, 0.01, 1.99};
  EXPECT_FALSE(is_level_below(slice) || is_level_above(slice));
  // A ball's poles are level; a barrel's flank, whose center is beyond the axis, meets the axis at
  // an angle.
  const ArcPiece ball{0, 3, 3, 0, 6}, barrel{-2, 5, 6, -1, 11};
  EXPECT_TRUE(is_level_below(ball) && is_level_above(ball));
  EXPECT_FALSE(is_level_below(barrel) || is_level_above(barrel));
}

TEST(ArcPiece, ArcBelowItsCenterIsWidestAtItsUpperEnd) {
  const ArcPiece below{2, 10, 5, 6, 7}, above{2, 10, 5, 13, 14}, around{2, 10, 5, 6, 14};
  EXPECT_EQ(extent(below).radius_mm, 2 + 4);
  EXPECT_EQ(extent(above).radius_mm, 2 + 4);
  EXPECT_EQ(extent(around).radius_mm, 7);
}

TEST(ArcPiece, BarrelRadiusIsNeverNegative) {
  const ArcPiece p{-3, 4, 5, 0, 8};
  EXPECT_EQ(radius_at(p, 0.0), 0);
  EXPECT_EQ(radius_at(p, 4.0), 2);
  EXPECT_EQ(radius_at(p, 8.0), 0);
}

TEST(ArcPiece, MatchesBruteForce) {
  std::mt19937 random(13);
  for (int n = 0; n < 200; ++n) {
    const double radius = test::between(random, 0.5, 8), center_z = test::between(random, 8, 12);
    const double center_r = test::between(random, -0.5 * radius, 6);
    // Heights at which the arc is beyond the axis.
    const double half = center_r >= 0 ? radius : std::sqrt(radius * radius - center_r * center_r);
    double a = test::between(random, -0.95, 0.95), b = test::between(random, -0.95, 0.95);
    if (a > b) std::swap(a, b);
    if (b - a < 0.05) continue;
    const ArcPiece p{center_r, center_z, radius, center_z + a * half, center_z + b * half};
    const auto inside = [&](test::HalfPoint q) {
      if (q.h < p.z0_mm || q.h > p.z1_mm) return false;
      return q.rho <= center_r ||
             (q.rho - center_r) * (q.rho - center_r) + (q.h - center_z) * (q.h - center_z) <=
                 radius * radius;
    };
    double widest = 0;
    std::vector<test::HalfPoint> side;
    for (int k = 0; k <= 4000; ++k) {
      const double angle = std::numbers::pi * (k / 4000.0 - 0.5);
      side.push_back({center_r + radius * std::cos(angle), center_z + radius * std::sin(angle)});
    }
    for (int k = 0; k <= 1000; ++k) {
      const double h = p.z0_mm + (p.z1_mm - p.z0_mm) * k / 1000;
      widest = std::max(widest, test::radius_by_bisection(inside, h, 20));
    }
    EXPECT_GE(extent(p).radius_mm, widest - 1e-9);
    EXPECT_LE(extent(p).radius_mm, widest + 1e-4);
    for (int k = 0; k < 20; ++k) {
      const double h = test::between(random, p.z0_mm, p.z1_mm);
      EXPECT_NEAR(radius_at(p, h), test::radius_by_bisection(inside, h, 20), 1e-9);
      const double step = 1e-6;
      if (h - step > p.z0_mm && h + step < p.z1_mm) {
        EXPECT_NEAR(slope_at(p, h), (radius_at(p, h + step) - radius_at(p, h - step)) / (2 * step),
                    1e-4);
      }
      const test::HalfPoint q{std::max(0.0, center_r) + test::between(random, 0, 2 * radius), h};
      const double sign = inside(q) ? -1 : 1;
      EXPECT_NEAR(side_distance(p, q.rho, q.h).mm, sign * test::nearest_of(side, q), 1e-3 * radius);
    }
  }
}

TEST(ArcPiece, LanesGiveTheBitsOfScalars) {
  const ArcPiece p{-3, 4, 5, 0.5, 7.25};
  const double heights[] = {0.4, 0.5, 1, 3.3, 4, 6.6, 7.25, 7.5};
  EXPECT_TRUE(test::lanes_match_scalars(
      heights, [&](Lanes z) { return radius_at(p, z); },
      [&](double z) { return radius_at(p, z); }));
  EXPECT_TRUE(test::lanes_match_scalars(
      heights, [&](Lanes z) { return slope_at(p, z); }, [&](double z) { return slope_at(p, z); }));
  EXPECT_TRUE(test::lanes_match_scalars(
      heights, [&](Lanes z) { return side_distance(p, Lanes(1.5), z).mm; },
      [&](double z) { return side_distance(p, 1.5, z).mm; }));
}

}  // namespace
}  // namespace kerf::arc_test
