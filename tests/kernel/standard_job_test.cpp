// SPDX-License-Identifier: Apache-2.0
// The standard job: exact values, end-point error against the true motion, and literal state
// hashes.

#include "tests/support/standard_job.h"

#include "tests/support/swept_oracle.h"
#include "tests/support/test.h"

namespace kerf::standard_job_test {
namespace {

Sculpture carve(bool five_axis, double pitch_mm, double tolerance_mm, const ToolShape& shape,
                std::size_t moves = 100000) {
  auto s = *Sculpture::create(test::standard_settings(pitch_mm, tolerance_mm));
  s.apply(DefineTool{1, *make_tool(shape)}).value();
  const std::vector<ToolPose> path = test::standard_path(five_axis);
  for (std::size_t i = 1; i < path.size() && i <= moves; ++i) {
    s.apply(MoveTool{1, path[i - 1], path[i], 0.01, false}).value();
  }
  return s;
}

TEST(StandardJob, ThreeAxisEndPointsAreExact) {
  auto s = carve(false, 0.5, 0.001, BallShape{10, 50});
  const DexelSnapshot snapshot = s.snapshot();
  const DexelGrid& g = snapshot.grid();
  std::vector<Dexel> scratch;
  double worst = 0;
  for (int j = 4; j < g.columns_y - 4; ++j) {
    for (int i = 12; i < g.columns_x - 12; ++i) {  // Without the rows' ends, where the tool turns.
      const auto column = snapshot.column(i, j, scratch);
      ASSERT_EQ(column.size(), 1u);
      worst = std::max(worst, std::abs(g.z_mm(column[0].top) - test::standard_surface(g.y_mm(j))));
    }
  }
  EXPECT_LE(worst, 1e-5);
  RecordProperty("worst_mm", std::to_string(worst));
}

TEST(StandardJob, ThreeAxisVolumeAtATenthOfAMillimetre) {
  auto s = carve(false, 0.1, 0.001, BallShape{10, 50});
  EXPECT_NEAR(s.removed_volume_mm3() / test::kStandardRemovedMm3, 1, 2e-4);
}

/// Returns the greatest end-point error along the ray of a five-axis carving with a ball, over a
/// sample of columns.
double worst_error(Sculpture& s, const std::vector<ToolPose>& path, std::size_t moves) {
  const DexelSnapshot snapshot = s.snapshot();
  const DexelGrid& g = snapshot.grid();
  const Tool tool = *make_tool(BallShape{10, 50});
  std::vector<Dexel> scratch;
  double worst = 0;
  for (int j = 1; j < g.columns_y; j += 5) {
    for (int i = 5; i < g.columns_x - 5; i += 23) {
      const double x = g.x_mm(i), y = g.y_mm(j);
      double lowest = 50;
      for (std::size_t k = 1; k < path.size() && k <= moves; ++k) {
        const Vec3 tip = path[k].tip_mm;
        if (std::abs(tip.x - x) > 14 || std::abs(tip.y - y) > 14) continue;
        for (const ToolPiece& piece : tool.pieces) {
          const Span span =
              test::swept_span(piece, path[k - 1], path[k], x, y, 40, lowest + 0.5, 4);
          if (span.lo < span.hi) lowest = std::min(lowest, span.lo);
        }
      }
      const auto column = snapshot.column(i, j, scratch);
      worst = std::max(worst, std::abs(g.z_mm(column.back().top) - lowest));
    }
  }
  return worst;
}

TEST(StandardJob, FiveAxisEndPointsAreWithinTolerance) {
  constexpr std::size_t kMoves = 1020;  // Ten rows: every tilt and direction of the job.
  for (const double tolerance : {0.001, 0.01}) {
    auto s = carve(true, 0.5, tolerance, BallShape{10, 50}, kMoves);
    EXPECT_LE(worst_error(s, test::standard_path(true), kMoves), tolerance);
  }
}

// Literal hashes: changing them changes the state that every journal replays to. They hold at any
// optimization level and on any CPU.
TEST(Determinism, StandardJobHashes) {
  EXPECT_EQ(carve(false, 0.5, 0.001, BallShape{10, 50}).state_hash(), 8953745086271116946ULL);
  EXPECT_EQ(carve(true, 0.5, 0.001, BallShape{10, 50}, 1500).state_hash(), 2946805470837216468ULL);
  EXPECT_EQ(carve(true, 0.5, 0.01, FlatShape{10, 50}, 600).state_hash(), 7218929693609648831ULL);
  EXPECT_EQ(carve(true, 0.5, 0.01, TaperShape{4, 12, 40}, 600).state_hash(),
            14610605400914223555ULL);
  EXPECT_EQ(carve(true, 0.5, 0.01, ConeEndShape{10, 90, 50}, 600).state_hash(),
            17299971750522877671ULL);
}

}  // namespace
}  // namespace kerf::standard_job_test
