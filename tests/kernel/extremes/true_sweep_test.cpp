// SPDX-License-Identifier: Apache-2.0
// Tests of the reference itself, since a reference that detects nothing would pass every kernel.

#include "tests/kernel/extremes/true_sweep.h"

#include "tests/kernel/extremes/carving.h"
#include "tests/support/test.h"

namespace kerf::test::true_sweep_test {
namespace {

constexpr Vec3 kUp{0, 0, 1};

TEST(TrueSweep, MatchesClosedFormDistances) {
  // A ball of radius 5 on a straight path is a capsule around the path of its center.
  const Tool ball = *make_tool(BallShape{10, 50});
  const TrueSweep sweep(ball, {{0, 0, 0}, kUp}, {{20, 0, 0}, kUp});
  EXPECT_NEAR(sweep.outside({7, 0, -2}, 10), 2, 1e-12);
  EXPECT_NEAR(sweep.outside({-4, 0, 1}, 10), std::sqrt(32.0) - 5, 1e-12);
  EXPECT_NEAR(sweep.outside({13, 3, 5}, 10), -2, 1e-12);
  EXPECT_NEAR(sweep.outside({10, 6, 30}, 10), 1, 1e-12);
}

TEST(TrueSweep, FindsANeedleOnALongPath) {
  const Tool needle = *make_tool(FlatShape{0.01, 5});
  const TrueSweep sweep(needle, {{-5000, 0, 0}, kUp}, {{5000, 0, 0}, kUp});
  EXPECT_NEAR(sweep.outside({1234.56789, 0.004, 1}, 1), -0.001, 1e-9);
  EXPECT_NEAR(sweep.outside({-987.654, 0.0052, 1}, 1), 0.0002, 1e-9);
}

TEST(TrueSweep, FollowsTheGreatCircle) {
  // The end of a lying tool that turns by 90 degrees about its tip draws a circle.
  const Tool tool = *make_tool(FlatShape{2, 10});
  const TrueSweep sweep(tool, {{0, 0, 0}, {1, 0, 0}}, {{0, 0, 0}, {0, 1, 0}});
  const double a = 0.3;
  EXPECT_NEAR(sweep.outside({9 * std::cos(a), 9 * std::sin(a), 1.5}, 5), 0.5, 1e-12);
  EXPECT_NEAR(sweep.outside({9 * std::cos(a), 9 * std::sin(a), 0.75}, 5), -0.25, 1e-12);
}

struct Wrong {
  const char* what;
  ToolShape judged;
  Vec3 shift;
};

/// Carves with one tool or path and verifies against another: a difference of two tolerances must
/// be detected.
TEST(Carving, DetectsAToolOrPathWrongByTwoTolerances) {
  constexpr double kTolerance = 1e-3;
  const ToolPose a = leaning({-3, 0.2, -4}, 0.2), b = leaning({3, 1, -5}, 0.35, 1);
  const Wrong wrongs[] = {{"too large", BallShape{9.996, 50}, {}},
                          {"too small", BallShape{10.004, 50}, {}},
                          {"too low", BallShape{10, 50}, {0, 0, 0.002}},
                          {"too high", BallShape{10, 50}, {0, 0, -0.002}},
                          {"beside", BallShape{10, 50}, {0, 0.003, 0}}};
  for (const Wrong& wrong : wrongs) {
    Carving carving(block(30, 16, 0.7, kTolerance), *make_tool(BallShape{10, 50}));
    carving.sculpture().apply(MoveTool{1, a, b, 0.01}).value();
    carving.judge_by(TrueSweep(*make_tool(wrong.judged), {a.tip_mm + wrong.shift, a.axis},
                               {b.tip_mm + wrong.shift, b.axis}));
    const double error = carving.error_mm(60, 1);
    EXPECT_GT(error, 1.5 * kTolerance) << wrong.what;
    EXPECT_LT(error, 4 * kTolerance) << wrong.what;
  }
}

TEST(Carving, DetectsASliverBetweenTwoPiecesOfATool) {
  // Thinner than the tolerance, so that no point of it is deeper than that within either piece.
  const Tool whole = *make_tool({FrustumPiece{0, 5, 5, 5}, FrustumPiece{5, 5, 50, 5}});
  const Tool gapped = *make_tool({FrustumPiece{0, 5, 5, 5}, FrustumPiece{5.000005, 5, 50, 5}});
  Carving carving(block(30, 16, 0.7, 1e-5), gapped);
  const ToolPose pose{{0.1, 0.2, -9}, kUp};
  carving.sculpture().apply(MoveTool{1, pose, pose, 0.01}).value();
  carving.judge_by(TrueSweep(whole, pose, pose));
  EXPECT_GT(carving.error_mm(60, 1), 1.5e-5);
}

}  // namespace
}  // namespace kerf::test::true_sweep_test
