// SPDX-License-Identifier: Apache-2.0
// The mechanistic law compared with published recordings of a dynamometer: J. Li, ForceCalculation,
// https://github.com/leekunhwee/ForceCalculation, commit 3fda341 (2019). Quoted are the means of
// its recordings, as forces on the tool: x along the feed, y to its left, z up.

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "kernel/sculpture.h"

namespace kerf {
namespace {

const Vec3 kUp{0, 0, 1};

/// A slot along +X.
struct Slot {
  Tool tool;
  double depth_mm, feed_mm_per_min;
  double pitch_mm;
};

/// Returns the mean force on a tool of two teeth in a slot.
Vec3 computed(const Slot& slot, MillingSettings milling) {
  milling.teeth = 2;
  milling.ripple_hz = 0;
  SculptureSettings s;
  s.stock = BoxStock{{-12, -14, -6}, {28, 14, 0}};
  s.rays = Rays::kTriDexel;
  s.pitch_mm = slot.pitch_mm;
  s.tolerance_mm = 0.001;
  s.keep_normals = false;
  s.force.law = ForceLaw::kMechanistic;
  s.force.milling = milling;
  Sculpture block = *Sculpture::create(s);
  block.apply(DefineTool{1, slot.tool}).value();
  constexpr double kStepMm = 0.1;
  constexpr int kLead = 20, kTicks = 60;
  const double tick_s = kStepMm / (slot.feed_mm_per_min / 60);
  const auto at = [&](double x) { return ToolPose{{x, 0, -slot.depth_mm}, kUp}; };
  block.apply(MoveTool{1, at(-40), at(0), 1, false}).value();
  Vec3 mean;
  for (int i = 0; i < kLead + kTicks; ++i) {
    const auto r = block.apply(MoveTool{1, at(i * kStepMm), at((i + 1) * kStepMm), tick_s}).value();
    if (i >= kLead) mean = mean + r.wrench.force_n * (1.0 / kTicks);
  }
  return mean;
}

/// A mean of a recording, and the greatest errors of the law: of the resultant's length, and of the
/// force as a vector, over the measured resultant.
struct Measured {
  double at;  ///< depth of cut, or feed per tooth, mm
  Vec3 force_n;
  double length_error, vector_error;
};

void expect_within(const Measured& m, Vec3 got, const char* tool) {
  const double wanted = length(m.force_n);
  EXPECT_LT(std::abs(length(got) - wanted), m.length_error * wanted)
      << tool << " " << m.at << " mm: " << got.x << " " << got.y << " " << got.z;
  EXPECT_LT(length(got - m.force_n), m.vector_error * wanted)
      << tool << " " << m.at << " mm: " << got.x << " " << got.y << " " << got.z;
}

/// Recordings of 2017-08-22, 20170822.mat: slots at 800 rpm and 0.1 mm per tooth; means of 13
/// turns. The coefficients are those of CommonCutterFull.m. They were not fitted to these
/// recordings; three of the six are those of Al7075-T6 in the review that milling_presets.cpp
/// quotes. The workpiece is not named.
MillingSettings of_2017() {
  MillingSettings m;
  m.spindle_rpm = 800;
  m.cut_n_per_mm2 = {796.1, 168.8, 222};
  m.edge_n_per_mm = {27.7, 30.8, 1.4};
  return m;
}

TEST(MillingPublished, BullNoseSlotsOfOtherDepthsThanTheCoefficients) {
  // 16 mm with a corner of 3 mm, as in CommonCutterFull.m. At 1 mm the bottom cuts most, where
  // the coefficients of a side do not hold.
  const Tool tool = *make_tool(BullNoseShape{16, 3, 30});
  for (const Measured& m :
       {Measured{1, {-26.9, 72.2, 46.1}, 0.23, 0.25}, Measured{2, {-60.8, 137.9, 57.5}, 0.09, 0.12},
        Measured{3, {-93.4, 199.8, 47.5}, 0.05, 0.09},
        Measured{4, {-107.3, 253.4, 28.4}, 0.07, 0.12},
        Measured{5, {-123.4, 310.3, 11.1}, 0.08, 0.13}}) {
    expect_within(m, computed({tool, m.at, 160, 0.25}, of_2017()), "bull nose");
  }
}

TEST(MillingPublished, BallSlotsOfOtherDepthsThanTheCoefficients) {
  // The diameter is the width of cut in the titles of CommonCutterFull.m's figures.
  const Tool tool = *make_tool(BallShape{16, 30});
  for (const Measured& m : {Measured{1, {-24.9, 93.5, 90.3}, 0.20, 0.21},
                            Measured{2, {-57.7, 169.0, 136.9}, 0.09, 0.10},
                            Measured{3, {-94.0, 243.7, 183.0}, 0.03, 0.06},
                            Measured{4, {-142.0, 318.6, 215.9}, 0.08, 0.09},
                            Measured{5, {-194.6, 382.1, 235.5}, 0.10, 0.12}}) {
    expect_within(m, computed({tool, m.at, 160, 0.25}, of_2017()), "ball");
  }
}

/// Recordings of 2018-03-15, "General/Flat end milling": slots with a flat mill of 25 mm, 3 mm deep
/// at 6000 rpm; means of 100 turns. The axial force has the sign of the repository's coefficients.
const std::vector<Measured> k2018{{0.025, {-39.80, 63.02, -55.72}, 0.24, 0.26},
                                  {0.050, {-60.05, 107.14, -70.91}, 0.08, 0.08},
                                  {0.075, {-71.60, 137.67, -82.57}, 0.05, 0.08},
                                  {0.100, {-76.75, 171.27, -85.23}, 0.02, 0.04},
                                  {0.125, {-78.49, 210.74, -83.50}, 0.05, 0.10}};

/// Returns the coefficients of the line through all means but one, by least squares over the feed
/// per tooth (Y. Altintas, Manufacturing Automation, mean forces of a slot).
MillingSettings fitted_without(std::size_t left_out) {
  double n = 0, feeds = 0, squares = 0;
  Vec3 forces, products;
  for (std::size_t i = 0; i < k2018.size(); ++i) {
    if (i == left_out) continue;
    const double f = k2018[i].at;
    n += 1;
    feeds += f;
    squares += f * f;
    forces = forces + k2018[i].force_n;
    products = products + k2018[i].force_n * f;
  }
  const Vec3 slope = (products * n - forces * feeds) * (1 / (n * squares - feeds * feeds));
  const Vec3 base = (forces - slope * feeds) * (1 / n);
  constexpr double kTeethDepth = 2 * 3;
  MillingSettings m;
  m.spindle_rpm = 6000;
  m.cut_n_per_mm2 = {4 * slope.y / kTeethDepth, -4 * slope.x / kTeethDepth,
                     -M_PI * slope.z / kTeethDepth};
  m.edge_n_per_mm = {M_PI * base.y / kTeethDepth, -M_PI * base.x / kTeethDepth,
                     -2 * base.z / kTeethDepth};
  return m;
}

TEST(MillingPublished, FlatSlotsOfOtherFeedsThanTheCoefficients) {
  // Each feed from the four others of the same series. The lowest is beyond the linear law.
  const Tool tool = *make_tool(FlatShape{25, 30});
  for (std::size_t i = 0; i < k2018.size(); ++i) {
    const double feed_mm_per_min = k2018[i].at * 2 * 6000;
    expect_within(k2018[i], computed({tool, 3, feed_mm_per_min, 0.5}, fitted_without(i)), "flat");
  }
}

}  // namespace
}  // namespace kerf
