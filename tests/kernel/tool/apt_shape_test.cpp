// SPDX-License-Identifier: Apache-2.0
#include "kernel/tool/tool.h"
#include "tests/support/test.h"
#include "tests/support/tool_profile.h"

namespace kerf::apt_shape_test {
namespace {

TEST(AptShape, ZeroAnglesAreABullNose) {
  EXPECT_EQ(*make_tool(AptShape{10, 1, 4, 1, 0, 0, 50}), *make_tool(BullNoseShape{10, 1, 50}));
}

TEST(AptShape, CornerOnTheAxisIsABall) {
  EXPECT_EQ(*make_tool(AptShape{10, 5, 0, 5, 0, 0, 50}), *make_tool(BallShape{10, 50}));
}

TEST(AptShape, ZeroCornerRadiusIsFlatOrACone) {
  EXPECT_EQ(*make_tool(AptShape{10, 0, 5, 0, 0, 0, 50}), *make_tool(FlatShape{10, 50}));
  const Tool cone = *make_tool(AptShape{10, 0, 5, 5, 45, 0, 30});
  const Tool same = *make_tool(ConeEndShape{10, 90, 30});
  ASSERT_EQ(cone.pieces.size(), 2u);
  EXPECT_NEAR(std::get<FrustumPiece>(cone.pieces[0]).z1_mm,
              std::get<FrustumPiece>(same.pieces[0]).z1_mm, 1e-12);
}

/// Returns the cutter whose corner arc touches both lines: its center is r above the bottom line
/// and r inside the side line, (-sin a, cos a) . x = r and (-cos b, sin b) . x = r about the point
/// where they meet.
AptShape tangent_cutter(double d, double r, double alpha_deg, double beta_deg, double h) {
  const double a = alpha_deg * M_PI / 180, b = beta_deg * M_PI / 180;
  const double det = std::cos(a + b);
  const double e = d / 2 + r * (std::sin(b) - std::cos(a)) / det;
  const double f = d / 2 * std::tan(a) + r * (std::cos(b) - std::sin(a)) / det;
  return {d, r, e, f, alpha_deg, beta_deg, h};
}

TEST(AptShape, ArcTouchesTheBottomAndTheSide) {
  for (const double alpha : {0.01, 5.0, 30.0, 60.0}) {
    for (const double beta : {-20.0, 0.0, 3.0, 25.0}) {
      const AptShape s = tangent_cutter(12, 2, alpha, beta, 16);
      const auto made = make_tool(s);
      ASSERT_TRUE(made) << alpha << " " << beta << " " << made.error().field << " "
                        << made.error().reason;
      ASSERT_EQ(made->pieces.size(), 3u);
      const auto bottom = std::get<FrustumPiece>(made->pieces[0]);
      const auto arc = std::get<ArcPiece>(made->pieces[1]);
      const auto side = std::get<FrustumPiece>(made->pieces[2]);
      EXPECT_EQ(bottom.z1_mm, arc.z0_mm);
      EXPECT_EQ(arc.z1_mm, side.z0_mm);
      const double a = alpha * M_PI / 180, b = beta * M_PI / 180;
      EXPECT_NEAR(bottom.r1_mm, s.e_mm + s.r_mm * std::sin(a), 1e-7);
      EXPECT_NEAR(bottom.z1_mm, s.f_mm - s.r_mm * std::cos(a), 1e-7);
      EXPECT_NEAR(bottom.r1_mm * std::tan(a), bottom.z1_mm, 1e-9);
      EXPECT_NEAR(side.r0_mm, s.e_mm + s.r_mm * std::cos(b), 1e-7);
      EXPECT_NEAR(side.z0_mm, s.f_mm - s.r_mm * std::sin(b), 1e-7);
      EXPECT_NEAR(side.r1_mm - side.r0_mm, (side.z1_mm - side.z0_mm) * std::tan(b), 1e-7);
    }
  }
}

TEST(AptShape, AnglesNearTheirLimitsGiveValidLines) {
  for (const double alpha : {1e-9, 1e-3, 45.0, 89.0, 89.99}) {
    const double h = 5 * std::tan(alpha * M_PI / 180);
    const auto t = make_tool(AptShape{10, 0, 5, h, alpha, 0, h + 10});
    if (h + 10 > kToolLengthMaxMm) {
      EXPECT_EQ(t.error().field, "f_mm") << alpha;
      continue;
    }
    ASSERT_TRUE(t) << alpha << " " << t.error().field << " " << t.error().reason;
    EXPECT_NEAR(test::volume(t->pieces, h + 10), M_PI * 25 * (h / 3 + 10), 1e-4 * (h + 10));
  }
  for (const double beta : {-89.0, -1e-9, 1e-9, 89.0}) {
    const double top = 5 + 0.05 * std::tan(beta * M_PI / 180);
    const auto t = make_tool(AptShape{10, 0, 5, 0, 0, beta, 0.05});
    ASSERT_TRUE(t) << beta;
    const auto side = std::get<FrustumPiece>(t->pieces[0]);
    EXPECT_NEAR(side.r1_mm, top, 1e-9);
  }
}

TEST(AptShape, VolumeIsThatOfConeTorusAndCylinder) {
  // Corner of radius 2 about (3, 2): disc, quarter ring (Pappus) and cylinder.
  const Tool t = *make_tool(AptShape{10, 2, 3, 2, 0, 0, 12});
  const double quarter = M_PI,
               centroid = 3 + 4 * 2 / (3 * M_PI);  // of the quarter disc of radius 2
  const double corner = M_PI * 9 * 2 + 2 * M_PI * centroid * quarter;
  EXPECT_NEAR(test::volume(t.pieces, 12), corner + M_PI * 25 * 10, 1e-3);
}

TEST(AptShape, LinesThatCrossTheArcCutItOff) {
  // The bottom plane cuts the arc at (5, 0), the cylinder cuts it at (6, 1).
  const Tool t = *make_tool(AptShape{12, 5, 2, 4, 0, 0, 30});
  ASSERT_EQ(t.pieces.size(), 2u);
  EXPECT_EQ(std::get<ArcPiece>(t.pieces[0]), (ArcPiece{2, 4, 5, 0, 1}));
  EXPECT_EQ(std::get<FrustumPiece>(t.pieces[1]), (FrustumPiece{1, 6, 30, 6}));
}

TEST(AptShape, NegativeCenterMakesABarrel) {
  // A flank of radius 60, widest (8 mm) at the height 20.
  const Tool t = *make_tool(AptShape{16, 60, -52, 20, 0, 0, 35});
  ASSERT_EQ(t.pieces.size(), 2u);
  EXPECT_EQ(std::get<ArcPiece>(t.pieces[0]), (ArcPiece{-52, 20, 60, 0, 20}));
  EXPECT_EQ(t.radius_mm, 8);
}

TEST(AptShape, MayEndWithinItsArc) {
  const Tool t = *make_tool(AptShape{16, 60, -52, 20, 0, 0, 12});
  ASSERT_EQ(t.pieces.size(), 1u);
  EXPECT_EQ(std::get<ArcPiece>(t.pieces[0]).z1_mm, 12);
  EXPECT_NEAR(t.radius_mm, -52 + std::sqrt(3600 - 64), 1e-12);
}

TEST(AptShape, TaperedBallRoundedToThreeDecimalsIsAccepted) {
  // d/2 = 3 (1 - sin 10)/cos 10 = 2.51736.
  const auto t = make_tool(AptShape{5.035, 3, 0, 3, 0, 10, 40});
  ASSERT_TRUE(t) << t.error().reason;
  const Tool exact = *make_tool(TaperShape{6, 10, 40, TaperTip::kBall});
  EXPECT_NEAR(t->radius_mm, exact.radius_mm, 1e-3);
}

struct Rejected {
  AptShape shape;
  ToolErrorCode code;
  const char* field;
};

TEST(AptShape, RejectsInconsistentFields) {
  const double nan = std::nan("");
  using enum ToolErrorCode;
  for (const auto& [shape, code, field] :
       std::vector<Rejected>{{{0, 1, 4, 1, 0, 0, 50}, kNotPositive, "d_mm"},
                             {{10, nan, 4, 1, 0, 0, 50}, kNotFinite, "r_mm"},
                             {{10, -1, 4, 1, 0, 0, 50}, kOutOfRange, "r_mm"},
                             {{10, 1, nan, 1, 0, 0, 50}, kNotFinite, "e_mm"},
                             {{10, 1, 4, 1, 90, 0, 50}, kOutOfRange, "alpha_deg"},
                             {{10, 1, 4, 1, -5, 0, 50}, kOutOfRange, "alpha_deg"},
                             {{10, 1, 4, 1, 0, 90, 50}, kOutOfRange, "beta_deg"},
                             {{10, 1, 4, 1, 0, -90, 50}, kOutOfRange, "beta_deg"},
                             {{10, 1, 4, 1, 0, 0, 0}, kNotPositive, "h_mm"},
                             {{10, 1, 4, 3, 0, 0, 50}, kInconsistent, "f_mm"},
                             {{10, 1, 2, 1, 0, 0, 50}, kInconsistent, "d_mm"},
                             {{10, 0, 4, 0, 0, 0, 50}, kInconsistent, "e_mm"},
                             {{10, 0, 5, 1, 0, 0, 50}, kInconsistent, "f_mm"},
                             {{10, 0, 5, 5, 45, 0, 4}, kTooShort, "h_mm"},
                             {{0.2, 5.1, -5, 3, 0, 0, 50}, kInconsistent, "f_mm"},
                             {{10, 10, -5, -1, 0, 0, 50}, kInconsistent, "e_mm"},
                             {{10, 0, 5, 0, 0, -45, 6}, kInconsistent, "beta_deg"},
                             {{10, 0, 5, 0, 0, 89.95, 50}, kOutOfRange, "beta_deg"}}) {
    const auto made = make_tool(shape);
    ASSERT_FALSE(made) << field;
    EXPECT_EQ(made.error().code, code) << field << " " << made.error().reason;
    EXPECT_EQ(made.error().field, field) << made.error().reason;
    EXPECT_FALSE(made.error().reason.empty());
  }
}

}  // namespace
}  // namespace kerf::apt_shape_test
