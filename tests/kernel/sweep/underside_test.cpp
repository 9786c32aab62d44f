// SPDX-License-Identifier: Apache-2.0
#include "kernel/sweep/underside.h"

#include "kernel/sweep/tool_motion.h"
#include "tests/support/test.h"

namespace kerf::underside_test {
namespace {

constexpr double kRoundingMm = 1e-12;

double bound_at(const Underside& underside, double x, double y, double reach) {
  Lanes z = Lanes(-std::numeric_limits<double>::infinity());
  underside.raise({Lanes(x), Lanes(y), reach}, z);
  return z[0];
}

TEST(Underside, IsTheBottomOfAMillAndTheConeBelowASide) {
  const ToolPose upright{{1, 2, 3}, {0, 0, 1}};
  const Underside mill(FrustumPiece{0, 4, 50, 4}, upright, upright);
  EXPECT_NEAR(bound_at(mill, 3, 3, 0.5), 3, 2 * kEdgeEpsilonMm);
  const Underside countersink(FrustumPiece{0, 1, 4, 5}, upright, upright);
  EXPECT_NEAR(bound_at(countersink, 1, 5, 0.5), 3 + 2 - 0.5, 2 * kEdgeEpsilonMm);
  EXPECT_NEAR(bound_at(countersink, 1, 2.5, 0.5), 3, 2 * kEdgeEpsilonMm);
}

TEST(Underside, FollowsTheArcAtTheNearestPointOfADisc) {
  const ToolPose upright{{1, 2, 3}, {0, 0, 1}};
  const Underside corner(ArcPiece{3, 2, 2, 0, 2}, upright, upright);
  EXPECT_NEAR(bound_at(corner, 3, 2, 0.5), 3, 2 * kEdgeEpsilonMm);
  EXPECT_NEAR(bound_at(corner, 5.5, 2, 0.5), 3 + 2 - std::sqrt(4 - 1.0), 2 * kEdgeEpsilonMm);
  const Underside flank(ArcPiece{-25, 12, 30, 0, 24}, upright, upright);
  EXPECT_NEAR(bound_at(flank, 1, 5.5, 0.5), 3 + 12 - std::sqrt(900 - 28.0 * 28), 1e-8);
}

TEST(Underside, HorizontalToolHasNoBound) {
  const ToolPose from{{0, 0, 0}, {1, 0, 0}}, to{{0, 0, 1}, {1, 0, 0}};
  const Underside level(FrustumPiece{0, 4, 50, 4}, from, to);
  EXPECT_EQ(bound_at(level, 3, 1, 0.5), -std::numeric_limits<double>::infinity());
}

const ToolPiece kSlices[] = {FrustumPiece{0, 4, 12, 4},    FrustumPiece{1, 2, 6, 5},
                             FrustumPiece{2, 5, 6, 1},     FrustumPiece{0, 0, 2, 5},
                             ArcPiece{3, 2, 2, 0, 2},      ArcPiece{-24.9954541, 12, 30, 0, 24},
                             ArcPiece{1.5, 7.7, 4, 4, 11}, ArcPiece{0, 5, 5, 0, 3}};

/// No point of the slice, at any share of a motion, is below the bound of a disc that it is over.
TEST(Underside, NoPointOfTheMovingSliceIsBelowIt) {
  std::mt19937_64 random(3);
  const test::Uniform in(random);
  int bounded = 0, tested = 0;
  for (int k = 0; k < 400; ++k) {
    const ToolPiece& slice = kSlices[std::size_t(k) % std::size(kSlices)];
    const Extent e = extent(slice);
    const double travel = k % 3 == 0 ? 4 : 0.2;
    const double turn = k % 5 == 0 ? 0 : k % 2 == 0 ? 0.08 : 0.004;
    const ToolPose from{{in(-1, 1), in(-1, 1), in(-1, 1)},
                        normalized({in(-0.8, 0.8), in(-0.8, 0.8), 1})};
    const ToolPose to{from.tip_mm + Vec3{in(-1, 1), in(-1, 1), in(-1, 1)} * travel,
                      normalized(from.axis + Vec3{in(-1, 1), in(-1, 1), in(-1, 1)} * turn)};
    const ToolMotion motion = make_motion(from, to, 50);
    const Underside underside(slice, from, motion.to);
    for (int n = 0; n < 300; ++n) {
      const ToolPose pose = motion.at(in(0, 1));
      const double height = n % 3 == 0 ? e.z0_mm : in(e.z0_mm, e.z1_mm), turned = in(0, 6.3);
      const Vec3 a = normalized(cross(pose.axis, Vec3{0.3, 1, 0.2})), b = cross(pose.axis, a);
      const Vec3 across = a * std::cos(turned) + b * std::sin(turned);
      const double radius = radius_at(slice, height) * (n % 2 == 0 ? 1 : in(0, 1));
      const Vec3 p = pose.tip_mm + pose.axis * height + across * radius;
      const double reach = in(0, 1.5), off = in(0, 1) * reach, heading = in(0, 6.3);
      const double bound =
          bound_at(underside, p.x + off * std::cos(heading), p.y + off * std::sin(heading), reach);
      ASSERT_LE(bound, p.z + kRoundingMm) << "motion " << k << " point " << n;
      bounded += bound > p.z - 1;
      ++tested;
    }
  }
  EXPECT_GT(bounded, tested / 5);  // the bound is useful
}

}  // namespace
}  // namespace kerf::underside_test
