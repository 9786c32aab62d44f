// SPDX-License-Identifier: Apache-2.0
// The mechanistic law compared with published recordings of a dynamometer: J. Li, ForceCalculation,
// https://github.com/leekunhwee/ForceCalculation, commit 3fda341 (2019). Quoted are the means of
// its recordings, as forces on the tool: x along the feed, y to its left, z up.

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "kernel/sculpture.h"
#include "tests/kernel/force/slot_fit.h"

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
  test::SlotMean mean;
  double length_error, vector_error;
};

/// Recordings with one tool at one speed of the spindle.
struct Series {
  const char* name;
  Tool tool;
  double corner_mm;  ///< of the edge's arc
  double rpm;
  double pitch_mm;
};

void expect_within(const Series& series, const Measured& m, MillingSettings milling) {
  milling.spindle_rpm = series.rpm;
  const double feed_mm_per_min = m.mean.feed_per_tooth_mm * 2 * series.rpm;
  const Vec3 got =
      computed({series.tool, m.mean.depth_mm, feed_mm_per_min, series.pitch_mm}, milling);
  const double wanted = length(m.mean.force_n);
  const double length_error = length(got) / wanted - 1;
  const double vector_error = length(got - m.mean.force_n) / wanted;
  const std::string which = std::string(series.name) + ", " + std::to_string(m.mean.depth_mm) +
                            " mm deep, " + std::to_string(m.mean.feed_per_tooth_mm) +
                            " mm per tooth";
  EXPECT_LT(std::abs(length_error), m.length_error) << which;
  EXPECT_LT(vector_error, m.vector_error) << which;
}

/// Recordings of 2017-08-22, 20170822.mat: slots at 800 rpm and 0.1 mm per tooth; means of 13
/// turns.
Series bull_nose() { return {"bull nose", *make_tool(BullNoseShape{16, 3, 30}), 3, 800, 0.25}; }
const Vec3 kBullNose[] = {{-26.9, 72.2, 46.1},
                          {-60.8, 137.9, 57.5},
                          {-93.4, 199.8, 47.5},
                          {-107.3, 253.4, 28.4},
                          {-123.4, 310.3, 11.1}};
/// The diameter is the width of cut in the titles of CommonCutterFull.m's figures.
Series ball() { return {"ball", *make_tool(BallShape{16, 30}), 8, 800, 0.25}; }
const Vec3 kBall[] = {{-24.9, 93.5, 90.3},
                      {-57.7, 169.0, 136.9},
                      {-94.0, 243.7, 183.0},
                      {-142.0, 318.6, 215.9},
                      {-194.6, 382.1, 235.5}};
/// Recordings of 2018-03-15, "General/Flat end milling": slots with a flat mill of 25 mm, 3 mm deep
/// at 6000 rpm; means of 100 turns. The axial force has the sign of the repository's coefficients.
Series flat() { return {"flat", *make_tool(FlatShape{25, 30}), 0, 6000, 0.5}; }
const Vec3 kFlat[] = {{-39.80, 63.02, -55.72},
                      {-60.05, 107.14, -70.91},
                      {-71.60, 137.67, -82.57},
                      {-76.75, 171.27, -85.23},
                      {-78.49, 210.74, -83.50}};

/// Means at depths of 1 to 5 mm, with the greatest error of each in percent: length, vector.
std::vector<Measured> at_depths(const Vec3 (&forces)[5], const double (&percent)[5][2]) {
  std::vector<Measured> all;
  for (int i = 0; i < 5; ++i)
    all.push_back({{1.0 + i, 0.1, forces[i]}, percent[i][0] / 100, percent[i][1] / 100});
  return all;
}
std::vector<Measured> at_feeds(const Vec3 (&forces)[5], const double (&percent)[5][2]) {
  std::vector<Measured> all;
  for (int i = 0; i < 5; ++i)
    all.push_back({{3, 0.025 * (i + 1), forces[i]}, percent[i][0] / 100, percent[i][1] / 100});
  return all;
}

/// The coefficients of CommonCutterFull.m. They were not fitted to these recordings; three of the
/// six are those of Al7075-T6 in the review that milling_presets.cpp quotes. The workpiece is not
/// named.
MillingSettings of_another_source() {
  MillingSettings m;
  m.cut_n_per_mm2 = {796.1, 168.8, 222};
  m.edge_n_per_mm = {27.7, 30.8, 1.4};
  return m;
}

TEST(MillingPublished, SlotsWithCoefficientsOfAnotherSource) {
  // At 1 mm the bottom cuts most, where the coefficients of a side do not hold.
  for (const Measured& m : at_depths(kBullNose, {{23, 25}, {9, 12}, {5, 9}, {7, 12}, {8, 13}}))
    expect_within(bull_nose(), m, of_another_source());
  for (const Measured& m : at_depths(kBall, {{20, 21}, {9, 10}, {3, 6}, {8, 9}, {10, 12}}))
    expect_within(ball(), m, of_another_source());
}

/// Expects each mean within its errors, with the coefficients that fit the others best.
void expect_each_from_the_others(const Series& series, const std::vector<Measured>& all) {
  for (std::size_t i = 0; i < all.size(); ++i) {
    std::vector<test::SlotMean> others;
    for (std::size_t j = 0; j < all.size(); ++j) {
      if (j != i) others.push_back(all[j].mean);
    }
    const test::SlotFit fit = test::SlotFitter(2, series.corner_mm).fit(others);
    MillingSettings milling;
    milling.cut_n_per_mm2 = fit.cut_n_per_mm2;
    milling.chip_exponents = fit.exponents;
    expect_within(series, all[i], milling);
  }
}

TEST(MillingPublished, EachSlotFromTheOthersWithAnExponentForEachDirection) {
  // The directions are less exact where a point lies beyond the others.
  const double bull_nose_errors[5][2] = {{10, 12}, {10, 10}, {10, 10}, {10, 10}, {10, 10}};
  const double ball_errors[5][2] = {{10, 10}, {10, 10}, {10, 10}, {10, 10}, {10, 10}};
  const double flat_errors[5][2] = {{10, 15}, {10, 10}, {10, 10}, {10, 10}, {10, 10}};
  expect_each_from_the_others(bull_nose(), at_depths(kBullNose, bull_nose_errors));
  expect_each_from_the_others(ball(), at_depths(kBall, ball_errors));
  expect_each_from_the_others(flat(), at_feeds(kFlat, flat_errors));
}

}  // namespace
}  // namespace kerf
