// SPDX-License-Identifier: Apache-2.0
#include "kernel/tool/convex_part.h"

#include "kernel/math/tolerance.h"
#include "kernel/tool/tool.h"
#include "tests/support/test.h"

namespace kerf::convex_part_test {
namespace {

std::vector<ConvexPart> parts_of(const ToolShape& shape) { return make_tool(shape)->whole_parts; }

TEST(ConvexPart, ConvexToolsHaveOnePart) {
  for (const ToolShape& shape :
       {ToolShape{BallShape{10, 40}}, ToolShape{FlatShape{10, 40}},
        ToolShape{BullNoseShape{10, 2, 40}}, ToolShape{ConeEndShape{10, 90, 40}},
        ToolShape{TaperShape{6, 8, 40, TaperTip::kBall}},
        ToolShape{AptShape{16, 60, -52, 20, 0, 0, 40}}}) {
    EXPECT_EQ(parts_of(shape).size(), 1) << shape.index();
  }
}

TEST(ConvexPart, SectionsInLineAreOnePiece) {
  const std::vector<ConvexPart> parts = convex_parts(std::vector<ToolPiece>{
      FrustumPiece{0, 2, 3, 2.9}, FrustumPiece{3, 2.9, 4, 3.2}, FrustumPiece{4, 3.2, 9, 4.7}});
  ASSERT_EQ(parts.size(), 1);
  ASSERT_EQ(parts[0].pieces.size(), 1);
  EXPECT_EQ(parts[0].pieces[0], ToolPiece(FrustumPiece{0, 2, 9, 4.7}));
  EXPECT_TRUE(parts[0].ridges_mm.empty());
}

TEST(ConvexPart, EndsWhereTheOutlineTurnsAway) {
  const std::vector<ConvexPart> parts =
      convex_parts(std::vector<ToolPiece>{FrustumPiece{0, 2, 10, 2}, FrustumPiece{10, 5, 20, 5},
                                          FrustumPiece{20, 5, 30, 3}, FrustumPiece{30, 3, 40, 3}});
  ASSERT_EQ(parts.size(), 3);
  EXPECT_EQ(extent(parts[1]).z0_mm, 10);
  EXPECT_EQ(extent(parts[1]).z1_mm, 30);
  EXPECT_EQ(radius_at(parts[1], 25), 4);
  EXPECT_EQ(radius_at(parts[1], 31), kNoRadiusMm);
  EXPECT_FALSE(parts[0].covered);
  EXPECT_FALSE(parts[1].covered);  // A shoulder.
  EXPECT_TRUE(parts[2].covered);
}

TEST(ConvexPart, PieceAtAJointIsTheUpperOne) {
  const ConvexPart part = convex_parts(std::vector<ToolPiece>{
      FrustumPiece{0, 1, 5, 4}, FrustumPiece{5, 4, 9, 4}, FrustumPiece{9, 4, 12, 2}})[0];
  ASSERT_EQ(part.pieces.size(), 3);
  for (const auto& [z, piece] : {std::pair{-1.0, 0},
                                 {0.0, 0},
                                 {4.9, 0},
                                 {5.0, 1},
                                 {8.9, 1},
                                 {9.0, 2},
                                 {12.0, 2},
                                 {13.0, 2}}) {
    EXPECT_EQ(&piece_at(part, z), &part.pieces[std::size_t(piece)]) << z;
  }
}

TEST(ConvexPart, RidgesAreWhereTheOutlineHasAnEdge) {
  EXPECT_EQ(parts_of(ConeEndShape{10, 90, 40})[0].ridges_mm.size(), 1);
  EXPECT_TRUE(parts_of(BullNoseShape{10, 2, 40})[0].ridges_mm.empty());
}

/// A fillet of many sections, each of which turns away slightly: the allowance does not add up.
TEST(ConvexPart, FilletIsNotFilled) {
  ProfileShape shape{{ProfilePoint{3, 0}, ProfileArc{{5, 10}, 30, ArcBulge::kIn}}, 1e-5};
  const Tool tool = *make_tool(shape);
  ASSERT_GT(tool.pieces.size(), 20);
  EXPECT_GT(tool.whole_parts.size(), 5);
  for (double z = 0.005; z < 10; z += 0.01) {
    double radius = 0, whole = 0;
    for (const ToolPiece& piece : tool.pieces) radius = std::max(radius, radius_at(piece, z));
    for (const ConvexPart& part : tool.whole_parts) whole = std::max(whole, radius_at(part, z));
    EXPECT_GE(whole, radius - 1e-12) << z;
    EXPECT_LT(whole, radius + 2 * kHullAllowanceMm) << z;
  }
}

TEST(ConvexPart, UncontinuedBallIsWhole) {
  const std::vector<ConvexPart> parts =
      convex_parts(std::vector<ToolPiece>{BallPiece{4, 4}, FrustumPiece{12, 1, 20, 1}});
  ASSERT_EQ(parts.size(), 2);
  EXPECT_EQ(extent(parts[0]).z1_mm, 8);
}

}  // namespace
}  // namespace kerf::convex_part_test
