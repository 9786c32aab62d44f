// SPDX-License-Identifier: Apache-2.0
#include "kernel/force/ripple.h"
#include "tests/support/side_cut.h"
#include "tests/support/test.h"

namespace kerf::light_cut_test {
namespace {

double worst_ripple(test::SideCut cut) {
  double worst = 0;
  for (const double degrees : test::kSideCutDegrees) {
    cut.degrees = degrees;
    worst = std::max(worst, test::side_cut_ripple(cut));
  }
  return worst;
}

TEST(LightCut, OneFieldIsSteadyFromTheStatedEngagement) {
  for (const double diameter_mm : {6.0, 12.0}) {
    for (const double pitch_mm : {0.05, 0.1, 0.2}) {
      const double steady_mm = steady_radial_mm(1, pitch_mm, diameter_mm);
      const test::SideCut cut{
          .radial_mm = steady_mm, .diameter_mm = diameter_mm, .pitch_mm = pitch_mm};
      EXPECT_LE(worst_ripple(cut), kSteadyRipple) << diameter_mm << " mm at " << pitch_mm;
      test::SideCut lighter = cut;
      lighter.radial_mm = steady_mm / 4;
      const double light = worst_ripple(lighter);
      EXPECT_GT(light, 2 * kSteadyRipple) << "otherwise the statement is too cautious";
      EXPECT_LE(light, 4 * kSteadyRipple) << "the ripple falls with the engagement";
    }
  }
}

TEST(LightCut, ThreeFieldsAreSteadyFromFivePitches) {
  for (const double diameter_mm : {6.0, 12.0}) {
    for (const double pitch_mm : {0.1, 0.2}) {
      EXPECT_LE(worst_ripple({.radial_mm = steady_radial_mm(3, pitch_mm, diameter_mm),
                              .depth_mm = 20.3 * pitch_mm,
                              .diameter_mm = diameter_mm,
                              .pitch_mm = pitch_mm,
                              .rays = Rays::kTriDexel,
                              .measured_mm = 3}),
                kSteadyRipple)
          << diameter_mm << " mm at " << pitch_mm;
    }
  }
}

}  // namespace
}  // namespace kerf::light_cut_test
