// SPDX-License-Identifier: Apache-2.0
#include "tests/kernel/force/published_slots.h"

#include "kernel/sculpture.h"

namespace kerf::test {
namespace {

constexpr int kTeeth = 2;

std::vector<SlotMean> at_depths(const std::vector<Vec3>& forces_n) {
  std::vector<SlotMean> means;
  for (const Vec3& force_n : forces_n) {
    means.push_back({1.0 + static_cast<double>(means.size()), 0.1, force_n});
  }
  return means;
}

std::vector<SlotMean> at_feeds(const std::vector<Vec3>& forces_n) {
  std::vector<SlotMean> means;
  for (const Vec3& force_n : forces_n) {
    means.push_back({3, 0.025 * (1.0 + static_cast<double>(means.size())), force_n});
  }
  return means;
}

/// Returns the mean force on the tool in a slot along +X.
Vec3 computed(const PublishedSlots& slots, const SlotMean& mean, const MillingSettings& milling) {
  Sculpture block =
      *Sculpture::create({.stock = BoxStock{{-12, -14, -6}, {28, 14, 0}},
                          .rays = Rays::kTriDexel,
                          .pitch_mm = slots.pitch_mm,
                          .tolerance_mm = 0.001,
                          .keep_normals = false,
                          .force = {.law = ForceLaw::kMechanistic, .milling = milling}});
  block.apply(DefineTool{1, slots.tool}).value();
  constexpr double kStepMm = 0.1;
  constexpr int kLead = 20, kTicks = 60;
  const double tick_s = kStepMm / (mean.feed_per_tooth_mm * kTeeth * slots.rpm / 60);
  const auto at = [&](double x) { return ToolPose{{x, 0, -mean.depth_mm}, {0, 0, 1}}; };
  block.apply(MoveTool{1, at(-40), at(0), 1, false}).value();
  Vec3 sum_n;
  for (int i = 0; i < kLead + kTicks; ++i) {
    const auto r = block.apply(MoveTool{1, at(i * kStepMm), at((i + 1) * kStepMm), tick_s}).value();
    if (i >= kLead) sum_n = sum_n + r.wrench.force_n;
  }
  return sum_n * (1.0 / kTicks);
}

MillingSettings fitted(const PublishedSlots& slots, const std::vector<SlotMean>& means) {
  const SlotFit fit = SlotFitter(kTeeth, slots.corner_mm).fit(means);
  return MillingSettings{.cut_n_per_mm2 = fit.cut_n_per_mm2, .chip_exponents = fit.exponents};
}

}  // namespace

/// Recordings of 2017-08-22, 20170822.mat: slots at 800 rpm and 0.1 mm per tooth; means of 13
/// turns.
PublishedSlots published_bull_nose() {
  return {.name = "bull nose 16 mm, r 3 mm",
          .tool = *make_tool(BullNoseShape{16, 3, 30}),
          .corner_mm = 3,
          .rpm = 800,
          .pitch_mm = 0.25,
          .means = at_depths({{-26.9, 72.2, 46.1},
                              {-60.8, 137.9, 57.5},
                              {-93.4, 199.8, 47.5},
                              {-107.3, 253.4, 28.4},
                              {-123.4, 310.3, 11.1}})};
}

/// From the same day. The diameter is the width of cut in the titles of CommonCutterFull.m's
/// figures.
PublishedSlots published_ball() {
  return {.name = "ball 16 mm",
          .tool = *make_tool(BallShape{16, 30}),
          .corner_mm = 8,
          .rpm = 800,
          .pitch_mm = 0.25,
          .means = at_depths({{-24.9, 93.5, 90.3},
                              {-57.7, 169.0, 136.9},
                              {-94.0, 243.7, 183.0},
                              {-142.0, 318.6, 215.9},
                              {-194.6, 382.1, 235.5}})};
}

/// Recordings of 2018-03-15, "General/Flat end milling": slots with a flat mill of 25 mm, 3 mm deep
/// at 6000 rpm; means of 100 turns. The axial force has the sign of the repository's coefficients.
PublishedSlots published_flat() {
  return {.name = "flat 25 mm",
          .tool = *make_tool(FlatShape{25, 30}),
          .corner_mm = 0,
          .rpm = 6000,
          .pitch_mm = 0.5,
          .means = at_feeds({{-39.80, 63.02, -55.72},
                             {-60.05, 107.14, -70.91},
                             {-71.60, 137.67, -82.57},
                             {-76.75, 171.27, -85.23},
                             {-78.49, 210.74, -83.50}})};
}

MillingSettings coefficients_of_another_source() {
  return MillingSettings{.cut_n_per_mm2 = {796.1, 168.8, 222}, .edge_n_per_mm = {27.7, 30.8, 1.4}};
}

MillingSettings fitted_to_all(const PublishedSlots& slots) { return fitted(slots, slots.means); }

MillingSettings fitted_to_the_others(const PublishedSlots& slots, std::size_t left_out) {
  std::vector<SlotMean> others = slots.means;
  others.erase(others.begin() + static_cast<std::ptrdiff_t>(left_out));
  return fitted(slots, others);
}

SlotError slot_error(const PublishedSlots& slots, const SlotMean& mean, MillingSettings milling) {
  milling.teeth = kTeeth;
  milling.ripple_hz = 0;
  milling.spindle_rpm = slots.rpm;
  const Vec3 force_n = computed(slots, mean, milling);
  const double measured_n = length(mean.force_n);
  return {length(force_n) / measured_n - 1, length(force_n - mean.force_n) / measured_n};
}

}  // namespace kerf::test
