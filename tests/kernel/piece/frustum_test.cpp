// SPDX-License-Identifier: Apache-2.0
#include "kernel/piece/frustum.h"

#include "tests/kernel/piece/piece_support.h"
#include "tests/support/test.h"

namespace kerf::frustum_test {
namespace {

TEST(FrustumPiece, RadiusSlopeAndExtentOfAConeOf45Degrees) {
  const FrustumPiece p{2, 1, 5, 4};
  EXPECT_EQ(slope(p), 1);
  EXPECT_EQ(slope_at(p, 3.0), 1);
  EXPECT_EQ(radius_at(p, 2.0), 1);
  EXPECT_EQ(radius_at(p, 5.0), 4);
  EXPECT_EQ(radius_at(p, 1.999), kNoRadiusMm);
  EXPECT_EQ(radius_at(p, 5.001), kNoRadiusMm);
  EXPECT_EQ(extent(p).z0_mm, 2);
  EXPECT_EQ(extent(p).z1_mm, 5);
  EXPECT_EQ(extent(p).radius_mm, 4);
  EXPECT_EQ(extent(FrustumPiece{0, 4, 1, 3}).radius_mm, 4);
  const FrustumSide side(p);
  EXPECT_DOUBLE_EQ(side.cosine, std::numbers::sqrt2 / 2);
  EXPECT_DOUBLE_EQ(side.distance(3.0, 1.0), std::numbers::sqrt2 / 2);
  EXPECT_EQ(side.distance(2.0, 1.0), 0);
}

TEST(FrustumPiece, CylinderHasNoSlope) {
  const FrustumPiece p{0, 3, 10, 3};
  EXPECT_EQ(slope(p), 0);
  EXPECT_EQ(FrustumSide(p).cosine, 1);
  EXPECT_EQ(FrustumSide(p).distance(3.5, 4.0), 0.5);
}

TEST(FrustumPiece, MatchesBruteForce) {
  std::mt19937 random(12);
  for (int n = 0; n < 200; ++n) {
    const double z0 = test::between(random, 0, 10);
    const FrustumPiece p{z0, test::between(random, 0, 5), z0 + test::between(random, 0.1, 10),
                         test::between(random, 0.1, 5)};
    // Inside is the convex hull of the two discs: the side of the line between their rims that
    // contains the axis.
    const auto inside = [&](test::HalfPoint q) {
      if (q.h < p.z0_mm || q.h > p.z1_mm) return false;
      return (q.rho - p.r0_mm) * (p.z1_mm - p.z0_mm) - (q.h - p.z0_mm) * (p.r1_mm - p.r0_mm) <= 0;
    };
    // The side, continued by its own length on both ends.
    std::vector<test::HalfPoint> side;
    for (int k = -2000; k <= 4000; ++k) {
      const double s = k / 2000.0;
      side.push_back({p.r0_mm + s * (p.r1_mm - p.r0_mm), p.z0_mm + s * (p.z1_mm - p.z0_mm)});
    }
    const double length = std::hypot(p.r1_mm - p.r0_mm, p.z1_mm - p.z0_mm);
    for (int k = 0; k < 20; ++k) {
      const double h = test::between(random, p.z0_mm, p.z1_mm);
      EXPECT_NEAR(radius_at(p, h), test::radius_by_bisection(inside, h, 20), 1e-9);
      const test::HalfPoint q{
          std::max(0.0, radius_at(p, h) + test::between(random, -1, 1) * length), h};
      const double sign = inside(q) ? -1 : 1;
      EXPECT_NEAR(FrustumSide(p).distance(q.rho, q.h - p.z0_mm), sign * test::nearest_of(side, q),
                  1e-3 * length);
    }
  }
}

TEST(FrustumPiece, LanesGiveTheBitsOfScalars) {
  const FrustumPiece p{2, 1.3, 5.7, 4.1};
  const double heights[] = {1.9, 2, 2.1, 3.3, 4.7, 5.6, 5.7, 5.8};
  EXPECT_TRUE(test::lanes_match_scalars(
      heights, [&](Lanes z) { return radius_at(p, z); },
      [&](double z) { return radius_at(p, z); }));
  EXPECT_TRUE(test::lanes_match_scalars(
      heights, [&](Lanes z) { return slope_at(p, z); }, [&](double z) { return slope_at(p, z); }));
  const FrustumSide side(p);
  EXPECT_TRUE(test::lanes_match_scalars(
      heights, [&](Lanes z) { return side.distance(Lanes(3.7), z); },
      [&](double z) { return side.distance(3.7, z); }));
}

}  // namespace
}  // namespace kerf::frustum_test
