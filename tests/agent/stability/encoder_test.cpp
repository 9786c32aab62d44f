// SPDX-License-Identifier: Apache-2.0
// Cuts that are felt through encoders, and strokes that begin and end.
#include "tests/agent/stability/encoder_cut.h"
#include "tests/agent/stability/stroke_cut.h"
#include "tests/support/test.h"

namespace kerf::agent::encoder_test {
namespace {

void expect_felt(const EncoderCut& cut) {
  const EncoderCutOutcome outcome = cut_by_encoder(cut);
  const FeltSums& f = outcome.force;
  ASSERT_GT(f.computed_mean(), 0.05) << "the test requires a force";
  EXPECT_NEAR(f.felt_mean() / f.computed_mean(), 1, 0.02) << name_of(cut.path);
  EXPECT_LT(f.error(), 0.05) << name_of(cut.path);
  EXPECT_NEAR(outcome.removed_share, 1, 0.05) << "at most half a quantum more or less";
}

TEST(Encoders, SlowCutIsFeltThroughCoarseSteps) {
  for (const StraightCut path : kStraightCuts) {
    expect_felt({.path = path, .mm_per_s = 5, .quantum_mm = 0.055, .quantum_rad = 0.001});
  }
}

TEST(Encoders, VerySlowPlungeIsFelt) {
  expect_felt({.path = StraightCut::kPlunge, .mm_per_s = 2, .quantum_mm = 0.055});
}

TEST(Encoders, StepsNeedNotBeDeclared) {
  expect_felt({.path = StraightCut::kSlot, .mm_per_s = 10, .quantum_mm = 0.043, .declared = false});
}

TEST(Encoders, FalconDriverEstimatesLegAngles) {
  for (const double mm_per_s : {2.0, 20.0}) {
    expect_felt({.path = StraightCut::kRamp, .mm_per_s = mm_per_s, .falcon = true});
  }
}

TEST(Encoders, SpeedDependentLawsGetAnEvenSpeed) {
  expect_felt({.path = StraightCut::kSlot, .mm_per_s = 10, .quantum_mm = 0.023, .law = "drr"});
  expect_felt(
      {.path = StraightCut::kSlot, .mm_per_s = 10, .quantum_mm = 0.023, .law = "mechanistic"});
}

TEST(Strokes, PeckingIsFeltAsComputed) {
  for (const double tilt : {0.0, 0.3}) {
    const StrokeOutcome peck =
        cut_stroke({.stroke = Stroke::kPecking, .rate = 3, .tilt_rad = tilt, .seconds = 2});
    ASSERT_GT(peck.force.computed_mean(), 0.05) << "the test requires a force";
    EXPECT_LT(peck.force.error(), peck.late_force.error() + 0.02) << tilt;
    EXPECT_LT(peck.torque.error(), peck.late_torque.error() + 0.02) << tilt;
    EXPECT_EQ(peck.soft_share, 0) << "an onset is no trembling";
    EXPECT_EQ(peck.trips, 0U);
  }
}

}  // namespace
}  // namespace kerf::agent::encoder_test
