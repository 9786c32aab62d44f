// SPDX-License-Identifier: Apache-2.0
#include "kernel/tool/tool.h"
#include "tests/support/test.h"

namespace kerf::tool_body_test {
namespace {

TEST(ToolBody, ShankAndHolderStackAboveTheCuttingLength) {
  ToolBody body;
  body.shank = Shank{8, 30};
  body.holder = std::vector<HolderSection>{{20, 30, 15}, {40, 40, 25}};
  const Tool t = *make_tool(FlatShape{10, 25}, body);
  EXPECT_EQ(t.pieces, make_tool(FlatShape{10, 25})->pieces);
  EXPECT_EQ(t.non_cutting,
            (std::vector<ToolPiece>{FrustumPiece{25, 4, 55, 4}, FrustumPiece{55, 10, 70, 15},
                                    FrustumPiece{70, 20, 95, 20}}));
  EXPECT_EQ(t.length_mm, 25);
  EXPECT_EQ(t.radius_mm, 5);
  EXPECT_EQ(t.whole_length_mm, 95);
  EXPECT_EQ(t.whole_radius_mm, 20);
}

TEST(ToolBody, HolderMayBeAProfile) {
  ToolBody body;
  body.holder = ProfileShape{
      {ProfilePoint{10, 0}, ProfileArc{{12, 2}, 2, ArcBulge::kOut}, ProfilePoint{12, 30}}};
  const Tool t = *make_tool(BallShape{6, 40}, body);
  EXPECT_EQ(t.non_cutting,
            (std::vector<ToolPiece>{ArcPiece{10, 42, 2, 40, 42}, FrustumPiece{42, 12, 70, 12}}));
}

TEST(ToolBody, SurvivesMakingAToolFromItsPieces) {
  ToolBody body{.shank = Shank{8, 30}};
  for (const ToolShape& shape :
       {ToolShape(BullNoseShape{10, 1, 25}), ToolShape(AptShape{10, 1, 4, 1, 0, 0, 50}),
        ToolShape(ProfileShape{{ProfilePoint{3, 0}, ProfilePoint{3, 9}}})}) {
    const Tool t = *make_tool(shape, body);
    EXPECT_EQ(std::get<FrustumPiece>(t.non_cutting[0]).z0_mm, t.length_mm);
    EXPECT_EQ(*make_tool(t.pieces, t.non_cutting), t);
  }
}

struct Rejected {
  ToolBody body;
  ToolErrorCode code;
  const char* field;
};

TEST(ToolBody, RejectionNamesTheFieldAndTheReason) {
  const double nan = std::nan("");
  using Sections = std::vector<HolderSection>;
  using enum ToolErrorCode;
  for (const auto& [body, code, field] : std::vector<Rejected>{
           {{Shank{0, 10}, {}}, kNotPositive, "shank.diameter_mm"},
           {{Shank{8, nan}, {}}, kNotFinite, "shank.length_mm"},
           {{Shank{8, 4999}, {}}, kOutOfRange, "shank.length_mm"},
           {{{}, Sections{{20, 20, 10}, {-1, 20, 10}}}, kNotPositive, "holder[1].diameter_mm"},
           {{{}, Sections{{20, 1e5, 10}}}, kOutOfRange, "holder[0].top_diameter_mm"},
           {{{}, Sections{{20, 20, 2500}, {20, 20, 2500}}}, kOutOfRange, "holder[1].length_mm"},
           {{{}, ProfileShape{{ProfilePoint{3, 1}, ProfilePoint{3, 5}}}},
            kInconsistent,
            "holder.profile_mm[0]"},
           {{{}, ProfileShape{{ProfilePoint{3, 0}, ProfilePoint{3, 5}}, 0}},
            kOutOfRange,
            "holder.chord_tolerance_mm"},
           {{{}, ProfileShape{{ProfilePoint{3, 0}, ProfilePoint{3, 4999}}}},
            kOutOfRange,
            "holder.profile_mm"}}) {
    const auto made = make_tool(FlatShape{10, 25}, body);
    ASSERT_FALSE(made) << field;
    EXPECT_EQ(made.error().field, field) << made.error().reason;
    EXPECT_EQ(made.error().code, code) << field << " " << made.error().reason;
  }
}

}  // namespace
}  // namespace kerf::tool_body_test
