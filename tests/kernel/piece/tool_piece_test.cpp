// SPDX-License-Identifier: Apache-2.0
#include "kernel/piece/tool_piece.h"

#include "kernel/math/rotation.h"
#include "kernel/piece/bounds.h"
#include "tests/kernel/piece/piece_support.h"
#include "tests/support/test.h"

namespace kerf::tool_piece_test {
namespace {

const ToolPiece kPieces[] = {BallPiece{5, 5}, FrustumPiece{2, 1, 9, 4}, FrustumPiece{0, 3, 4, 3},
                             ArcPiece{4, 1, 1, 0, 1}, ArcPiece{-3, 4, 5, 1, 7.5}};

TEST(ToolPiece, EnclosingFrustumIsNowhereNarrower) {
  for (const ToolPiece& piece : kPieces) {
    const FrustumPiece around = enclosing_frustum(piece);
    EXPECT_EQ(around.z0_mm, extent(piece).z0_mm);
    EXPECT_EQ(around.z1_mm, extent(piece).z1_mm);
    for (int k = 0; k <= 100; ++k) {
      const double h = around.z0_mm + (around.z1_mm - around.z0_mm) * k / 100;
      EXPECT_GE(radius_at(around, h), radius_at(piece, h) - 1e-12);
    }
  }
  EXPECT_EQ(enclosing_frustum(FrustumPiece{2, 1, 9, 4}), (FrustumPiece{2, 1, 9, 4}));
}

TEST(ToolPiece, SliceHasTheRadiiOfTheWhole) {
  for (const ToolPiece& piece : {kPieces[1], kPieces[3], kPieces[4]}) {
    const Extent whole = extent(piece);
    const double a = whole.z0_mm + 0.3 * (whole.z1_mm - whole.z0_mm);
    const double b = whole.z0_mm + 0.8 * (whole.z1_mm - whole.z0_mm);
    const ToolPiece slice = slice_of(piece, a, b);
    EXPECT_EQ(extent(slice).z0_mm, a);
    EXPECT_EQ(extent(slice).z1_mm, b);
    EXPECT_EQ(radius_at(slice, a - 0.01), kNoRadiusMm);
    for (int k = 0; k <= 10; ++k) {
      const double h = std::min(b, a + (b - a) * k / 10);
      EXPECT_NEAR(radius_at(slice, h), radius_at(piece, h), 1e-12);
    }
  }
}

TEST(ToolPiece, ProfileGivesTheDistancesOfItsPiece) {
  std::mt19937 random(14);
  for (const ToolPiece& piece : kPieces) {
    const PieceProfile profile(piece);
    EXPECT_EQ(profile.z0_mm, extent(piece).z0_mm);
    EXPECT_EQ(profile.z1_mm, extent(piece).z1_mm);
    for (int k = 0; k < 100; ++k) {
      const double rho = test::between(random, 0, 10), h = test::between(random, -2, 12);
      if (const auto* f = std::get_if<FrustumPiece>(&piece)) {
        ASSERT_EQ(profile.side, PieceProfile::Side::kLine);
        EXPECT_EQ(profile.line_distance(rho, h), FrustumSide(*f).distance(rho, h - f->z0_mm));
      } else if (const auto* ball = std::get_if<BallPiece>(&piece)) {
        ASSERT_EQ(profile.side, PieceProfile::Side::kBall);
        EXPECT_EQ(profile.arc_distance(rho, h).mm, side_distance(*ball, rho, h).mm);
      } else {
        ASSERT_EQ(profile.side, PieceProfile::Side::kArc);
        EXPECT_EQ(profile.arc_distance(rho, h).mm,
                  side_distance(std::get<ArcPiece>(piece), rho, h).mm);
      }
    }
  }
}

TEST(Bounds, CylinderBoundsAreThoseOfItsRims) {
  std::mt19937 random(15);
  for (int n = 0; n < 100; ++n) {
    const Extent e{test::between(random, 0, 5), test::between(random, 6, 20),
                   test::between(random, 0.1, 5)};
    const Vec3 tip{test::between(random, -9, 9), test::between(random, -9, 9), 3};
    const Vec3 axis = normalized(
        {test::between(random, -1, 1), test::between(random, -1, 1), test::between(random, -1, 1)});
    const Bounds box = cylinder_bounds(e, tip, axis);
    const Vec3 x = any_perpendicular(axis), y = cross(axis, x);
    Vec3 lo{1e9, 1e9, 1e9}, hi{-1e9, -1e9, -1e9};
    for (int k = 0; k < 2000; ++k) {
      const double a = 2 * std::numbers::pi * k / 2000;
      for (const double z : {e.z0_mm, e.z1_mm}) {
        const Vec3 p = tip + axis * z + (x * std::cos(a) + y * std::sin(a)) * e.radius_mm;
        lo = {std::min(lo.x, p.x), std::min(lo.y, p.y), std::min(lo.z, p.z)};
        hi = {std::max(hi.x, p.x), std::max(hi.y, p.y), std::max(hi.z, p.z)};
      }
    }
    for (const auto c : {&Vec3::x, &Vec3::y, &Vec3::z}) {
      EXPECT_NEAR(box.lo_mm.*c, lo.*c, 1e-4);
      EXPECT_NEAR(box.hi_mm.*c, hi.*c, 1e-4);
      EXPECT_LE(box.lo_mm.*c, lo.*c + 1e-12);
      EXPECT_GE(box.hi_mm.*c, hi.*c - 1e-12);
    }
  }
}

TEST(Bounds, JoinedAndGrown) {
  const Bounds a{{0, 1, 2}, {3, 4, 5}}, b{{-1, 2, 0}, {2, 9, 4}};
  const Bounds both = joined(a, b), larger = grown(a, 2);
  EXPECT_EQ(both.lo_mm, (Vec3{-1, 1, 0}));
  EXPECT_EQ(both.hi_mm, (Vec3{3, 9, 5}));
  EXPECT_EQ(larger.lo_mm, (Vec3{-2, -1, 0}));
  EXPECT_EQ(larger.hi_mm, (Vec3{5, 6, 7}));
}

}  // namespace
}  // namespace kerf::tool_piece_test
