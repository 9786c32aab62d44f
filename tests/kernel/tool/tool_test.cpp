// SPDX-License-Identifier: Apache-2.0
#include "kernel/tool/tool.h"

#include "tests/support/test.h"

namespace kerf::tool_test {
namespace {

TEST(Tool, BallIsABallAndACylinder) {
  const Tool t = *make_tool(BallShape{10, 50});
  ASSERT_EQ(t.pieces.size(), 2u);
  EXPECT_EQ(std::get<BallPiece>(t.pieces[0]), (BallPiece{5, 5}));
  EXPECT_EQ(std::get<FrustumPiece>(t.pieces[1]), (FrustumPiece{5, 5, 50, 5}));
  EXPECT_EQ(t.length_mm, 50);
  EXPECT_EQ(t.radius_mm, 5);
}

TEST(Tool, TaperWithBallTouchesItsSide) {
  const Tool t = *make_tool(TaperShape{6, 30, 40, TaperTip::kBall});
  const auto ball = std::get<BallPiece>(t.pieces[0]);
  const auto side = std::get<FrustumPiece>(t.pieces[1]);
  // The lower rim is on the ball, and the side is tangent there: its slope is tan 30.
  EXPECT_NEAR(std::hypot(side.r0_mm, side.z0_mm - ball.center_mm), ball.radius_mm, 1e-12);
  EXPECT_NEAR((side.r1_mm - side.r0_mm) / (side.z1_mm - side.z0_mm), std::tan(M_PI / 6), 1e-12);
  EXPECT_NEAR(side.r0_mm / (ball.center_mm - side.z0_mm), 1 / std::tan(M_PI / 6), 1e-12);
}

TEST(Tool, ConeEndHasItsAngle) {
  const Tool t = *make_tool(ConeEndShape{10, 90, 30});
  EXPECT_EQ(std::get<FrustumPiece>(t.pieces[0]).r0_mm, 0);
  EXPECT_NEAR(std::get<FrustumPiece>(t.pieces[0]).z1_mm, 5, 1e-12);
}

TEST(Tool, BullNoseIsARoundedCornerAndACylinder) {
  const Tool t = *make_tool(BullNoseShape{10, 2, 50});
  ASSERT_EQ(t.pieces.size(), 2u);
  EXPECT_EQ(std::get<ArcPiece>(t.pieces[0]), (ArcPiece{3, 2, 2, 0, 2}));
  EXPECT_EQ(std::get<FrustumPiece>(t.pieces[1]), (FrustumPiece{2, 5, 50, 5}));
  EXPECT_EQ(t.radius_mm, 5);
}

TEST(Tool, BullNoseLimitsAreFlatAndBall) {
  EXPECT_EQ(*make_tool(BullNoseShape{10, 0, 50}), *make_tool(FlatShape{10, 50}));
  EXPECT_EQ(*make_tool(BullNoseShape{10, 5, 50}), *make_tool(BallShape{10, 50}));
  EXPECT_EQ(make_tool(BullNoseShape{10, 2, 2})->pieces.size(), 1u);
}

TEST(Tool, HasLengthsWithAndWithoutNonCuttingPieces) {
  const Tool t = *make_tool({FrustumPiece{0, 3, 20, 3}}, {FrustumPiece{20, 10, 60, 15}});
  EXPECT_EQ(t.length_mm, 20);
  EXPECT_EQ(t.radius_mm, 3);
  EXPECT_EQ(t.whole_length_mm, 60);
  EXPECT_EQ(t.whole_radius_mm, 15);
  EXPECT_EQ(make_tool({FrustumPiece{0, 3, 20, 3}}, {BallPiece{-1, 2}}).error().field,
            "non_cutting");
}

struct Rejected {
  ToolShape shape;
  ToolErrorCode code;
  const char* field;
};

TEST(Tool, RejectsInvalidShapes) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double inf = std::numeric_limits<double>::infinity();
  using enum ToolErrorCode;
  for (const auto& [shape, code, field] :
       std::vector<Rejected>{{BallShape{nan, 50}, kNotFinite, "diameter_mm"},
                             {BallShape{10, inf}, kNotFinite, "length_mm"},
                             {BallShape{0, 50}, kNotPositive, "diameter_mm"},
                             {BallShape{-1, 50}, kNotPositive, "diameter_mm"},
                             {BallShape{10, 4}, kTooShort, "length_mm"},
                             {BallShape{1e5, 1e6}, kOutOfRange, "diameter_mm"},
                             {FlatShape{1e-9, 50}, kOutOfRange, "diameter_mm"},
                             {BullNoseShape{10, 5.1, 50}, kOutOfRange, "corner_radius_mm"},
                             {BullNoseShape{10, -1, 50}, kNotPositive, "corner_radius_mm"},
                             {BullNoseShape{10, nan, 50}, kNotFinite, "corner_radius_mm"},
                             {BullNoseShape{10, 2, 1.9}, kTooShort, "length_mm"},
                             {TaperShape{4, 0, 40}, kOutOfRange, "half_angle_deg"},
                             {TaperShape{4, 90, 40}, kOutOfRange, "half_angle_deg"},
                             {TaperShape{4, 89.99, 4000}, kOutOfRange, "half_angle_deg"},
                             {TaperShape{10, 10, 2, TaperTip::kBall}, kTooShort, "length_mm"},
                             {ConeEndShape{10, 180, 40}, kOutOfRange, "tip_angle_deg"},
                             {ConeEndShape{10, nan, 40}, kNotFinite, "tip_angle_deg"},
                             {ConeEndShape{10, 20, 5}, kTooShort, "length_mm"}}) {
    const auto made = make_tool(shape);
    ASSERT_FALSE(made) << field;
    EXPECT_EQ(made.error().code, code) << field;
    EXPECT_EQ(made.error().field, field);
    EXPECT_FALSE(made.error().reason.empty());
  }
}

TEST(Tool, RejectsInvalidPiecesFromAJournal) {
  EXPECT_FALSE(make_tool(std::vector<ToolPiece>{}));
  EXPECT_FALSE(make_tool(std::vector<ToolPiece>{FrustumPiece{5, 1, 5, 1}}));
  EXPECT_FALSE(make_tool(std::vector<ToolPiece>{FrustumPiece{0, 0, 5, 0}}));
  EXPECT_FALSE(make_tool(std::vector<ToolPiece>{BallPiece{5, std::nan("")}}));
  EXPECT_FALSE(make_tool(std::vector<ToolPiece>{ArcPiece{3, 2, 2, 0, 4.1}}));
  EXPECT_FALSE(make_tool(std::vector<ToolPiece>{ArcPiece{-3, 2, 4, 0, 6}}));  // r(6) = -3
  EXPECT_FALSE(make_tool(std::vector<ToolPiece>(1025, BallPiece{5, 5})));
}

}  // namespace
}  // namespace kerf::tool_test
