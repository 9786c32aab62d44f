// SPDX-License-Identifier: Apache-2.0
#include "kernel/sweep/tool_above.h"

#include "kernel/sweep/moving_slice.h"
#include "tests/support/test.h"

namespace kerf::tool_above_test {
namespace {

constexpr double kTopMm = 4;

/// Returns how far the point is outside the tool at a pose, below zero inside.
double outside(const Tool& tool, const ToolPose& pose, Vec3 point) {
  const Vec3 from_tip = point - pose.tip_mm;
  const double l = dot(from_tip, pose.axis);
  const double rho = std::sqrt(std::max(0.0, dot(from_tip, from_tip) - l * l));
  double least = 1e300;
  for (const ToolPiece& piece : tool.pieces) {
    const double radius = radius_at(piece, l);
    if (radius >= 0) least = std::min(least, rho - radius);
  }
  return least;
}

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  double in(double a, double b) { return std::uniform_real_distribution<double>(a, b)(engine_); }

 private:
  std::mt19937_64 engine_;
};

ToolMotion motion(Random& random, double turn, double length_mm) {
  ToolPose from{{0, 0, random.in(-4, 3)},
                normalized(Vec3{random.in(-0.3, 0.3), random.in(-0.3, 0.3), 1})};
  ToolPose to{from.tip_mm + Vec3{random.in(-1, 1), random.in(-1, 1), random.in(-1, 1)}, from.axis};
  if (turn > 0) {
    to.axis = normalized(from.axis + Vec3{random.in(-turn, turn), random.in(-turn, turn), 0});
  }
  return make_motion(from, to, length_mm);
}

ColumnBlock block(Random& random) {
  ColumnBlock b;
  const double x = random.in(-6, 6), y = random.in(-6, 6), pitch = random.in(0.02, 0.4);
  for (int i = 0; i < kLanes; ++i) b.x_mm.set(i, x + i * pitch);
  for (int j = 0; j < kBlockSide; ++j) b.y_mm[j] = y + j * pitch;
  b.rows = 0xFF;
  b.top_mm = b.grid_top_mm = kTopMm;
  b.lowest_mm = Lanes(-100);
  b.clear();
  return b;
}

/// Expects the tool, wherever the piece meets a raised column, to contain the whole column from
/// there to the top. Returns the number of columns tested.
int expect_raised_columns_are_inside(const Tool& tool, std::size_t which, const ToolMotion& m,
                                     ColumnBlock& b) {
  ToolAbove(tool, which, m, kTopMm).find_covered(b);
  int tested = 0;
  for (int step = 0; step <= 8; ++step) {
    const ToolPose pose = m.at(step / 8.0);
    ColumnBlock standing = b;
    standing.raised_rows = 0;
    MovingSlice(tool.pieces[which], pose, pose, {true, true}, {.top_mm = kTopMm})
        .evaluate(standing);
    for (int row = 0; row < kBlockSide; ++row) {
      if (((b.raised_rows & standing.filled) >> row & 1) == 0) continue;
      for (int lane = 0; lane < kLanes; ++lane) {
        const double lo = standing.lo_mm[row][lane];
        if ((bits(b.loses_all_above(row)) >> lane & 1) == 0 || !(lo <= kTopMm)) continue;
        ++tested;
        for (int k = 1; k <= 10; ++k) {  // The end itself is at the border.
          const double z = lo + (kTopMm - lo) * k / 10;
          const double off = outside(tool, pose, {b.x_mm[lane], b.y_mm[row], z});
          EXPECT_LE(off, 1e-9) << "piece " << which << " row " << row << " lane " << lane;
          if (off > 1e-9) return tested;
        }
      }
    }
  }
  return tested;
}

TEST(ToolAbove, RaisedColumnsAreInsideTheToolFromThePieceToTheTop) {
  const ToolShape shapes[] = {
      BullNoseShape{10, 2, 30},
      ConeEndShape{8, 90, 30},
      TaperShape{6, 8, 30, TaperTip::kBall},
      AptShape{10, 1.5, 3.630717035815369, 2.0250053615596113, 8, 6, 40},
      ProfileShape{
          {ProfilePoint{2, 0}, ProfilePoint{6, 4}, ProfilePoint{2, 8}, ProfilePoint{2, 30}}},
      ProfileShape{{ProfilePoint{6, 0}, ProfilePoint{6, 3}, ProfilePoint{2, 3}, ProfilePoint{2, 4},
                    ProfilePoint{8, 4}, ProfilePoint{8, 9}}},
      ProfileShape{{ProfilePoint{1, 0}, ProfilePoint{4, 2}, ProfilePoint{4, 3}}}};
  Random random(11);
  int tested = 0;
  for (int round = 0; round < 400; ++round) {
    for (const ToolShape& shape : shapes) {
      const Tool tool = *make_tool(shape);
      const ToolMotion m = motion(random, round % 3 * 0.05, tool.length_mm);
      for (std::size_t which = 0; which < tool.pieces.size(); ++which) {
        if (std::holds_alternative<BallPiece>(tool.pieces[which])) continue;
        ColumnBlock b = block(random);
        tested += expect_raised_columns_are_inside(tool, which, m, b);
      }
    }
  }
  EXPECT_GT(tested, 20000);
}

TEST(ToolAbove, NothingIsCoveredBelowANeckOrBeyondTheTool) {
  const Tool slot = *make_tool(ProfileShape{
      {ProfilePoint{6, 0}, ProfilePoint{6, 3}, ProfilePoint{2, 3}, ProfilePoint{2, 30}}});
  const Tool low = *make_tool(ConeEndShape{8, 90, 6});
  const ToolPose pose{{0, 0, -3}, {0, 0, 1}};
  const ToolMotion rest = make_motion(pose, pose, 30);
  Random random(1);
  ColumnBlock b = block(random);
  for (int i = 0; i < kLanes; ++i) b.x_mm.set(i, 0.1 * i);
  for (int j = 0; j < kBlockSide; ++j) b.y_mm[j] = 0.1 * j;
  ToolAbove(slot, 0, rest, kTopMm).find_covered(b);
  EXPECT_EQ(b.raised_rows, 0U);
  ToolAbove(low, 0, rest, kTopMm).find_covered(b);
  EXPECT_EQ(b.raised_rows, 0U);
  ToolAbove(*make_tool(ConeEndShape{8, 90, 9}), 0, rest, kTopMm).find_covered(b);
  EXPECT_EQ(b.raised_rows, 0xFFU);
}

}  // namespace
}  // namespace kerf::tool_above_test
