// SPDX-License-Identifier: Apache-2.0
// The mechanistic law at feeds of 0.1 to 3 µm per tooth, as in micro-milling and with dental burs.
#include "kernel/sculpture.h"
#include "tests/support/test.h"

namespace kerf::small_feed_test {
namespace {

constexpr double kRadiusMm = 0.25, kStepMm = 0.01;
constexpr int kTeeth = 2;
const Vec3 kUp{0, 0, 1};

SculptureSettings settings_of(const MillingSettings& milling) {
  return SculptureSettings{.stock = BoxStock{{-1, -1, -0.5}, {1, 1, 0}},
                           .rays = Rays::kTriDexel,
                           .pitch_mm = 0.02,
                           .tolerance_mm = 0.0005,
                           .keep_normals = false,
                           .force = {.law = ForceLaw::kMechanistic, .milling = milling}};
}

/// Returns the mean force on a flat mill of 0.5 mm in a slot along +X.
Vec3 slot_force_n(MillingSettings milling, double feed_per_tooth_mm, double depth_mm) {
  milling.teeth = kTeeth;
  milling.ripple_hz = 0;
  Sculpture block = *Sculpture::create(settings_of(milling));
  block.apply(DefineTool{1, *make_tool(FlatShape{2 * kRadiusMm, 3})}).value();
  const double tick_s = kStepMm / (feed_per_tooth_mm * kTeeth * milling.spindle_rpm / 60);
  const auto at = [&](double x) { return ToolPose{{x, 0, -depth_mm}, kUp}; };
  block.apply(MoveTool{1, at(-2), at(-0.5), 1, false}).value();
  Vec3 sum;
  constexpr int kLead = 10, kTicks = 40;
  for (int i = 0; i < kLead + kTicks; ++i) {
    const auto r =
        block.apply(MoveTool{1, at(-0.5 + i * kStepMm), at(-0.5 + (i + 1) * kStepMm), tick_s});
    if (i >= kLead) sum = sum + r.value().wrench.force_n * (1.0 / kTicks);
  }
  return sum;
}

/// A measured force; the table does not say whether it is a mean or a peak.
struct Measured {
  double rpm, feed_um, depth_mm, force_n;
};
/// "Modified Mechanistic Model Based on Gaussian Process Adjusting Technique for Cutting Force
/// Prediction in Micro-End Milling", Mathematical Problems in Engineering 2019, 7468698, table 1.
constexpr Measured kMeasured[] = {
    {20000, 0.4, 0.10, 3.25}, {20000, 2.4, 0.10, 4.23}, {20000, 0.4, 0.15, 5.13},
    {20000, 1.4, 0.15, 5.54}, {20000, 2.4, 0.15, 6.83}, {20000, 1.4, 0.20, 7.93},
    {20000, 2.4, 0.20, 9.56}, {30000, 0.4, 0.10, 2.67}, {30000, 1.4, 0.10, 5.08},
    {30000, 0.4, 0.15, 5.39}, {30000, 1.4, 0.15, 6.75}, {30000, 2.4, 0.15, 6.27},
    {30000, 0.4, 0.20, 5.46}, {30000, 1.4, 0.20, 6.94}, {40000, 1.4, 0.10, 4.10},
    {40000, 2.4, 0.10, 5.12}, {40000, 0.4, 0.15, 4.07}, {40000, 1.4, 0.15, 5.32},
    {40000, 1.4, 0.20, 6.96}, {40000, 2.4, 0.20, 8.87}, {20000, 1.4, 0.10, 4.29},
    {20000, 0.4, 0.20, 7.69}, {30000, 2.4, 0.10, 4.99}, {30000, 2.4, 0.20, 8.43},
    {40000, 0.4, 0.10, 2.53}, {40000, 2.4, 0.15, 5.92}, {40000, 0.4, 0.20, 5.49}};

double mean_measured_n(double feed_um, double depth_mm) {
  double sum = 0;
  int count = 0;
  for (const Measured& m : kMeasured) {
    if (m.feed_um != feed_um || m.depth_mm != depth_mm) continue;
    sum += m.force_n;
    ++count;
  }
  return sum / count;
}

/// Returns coefficients of the linear-edge model, two numbers that fit the 27 forces best: least
/// squares of relative errors of depth x (edge + cut x feed). Directions were not measured;
/// tangential and radial forces are assumed to be 1 to 0.3.
MillingSettings fitted_to_table() {
  double ee = 0, ec = 0, cc = 0, e = 0, c = 0;
  for (const Measured& m : kMeasured) {
    const double edge = m.depth_mm / m.force_n, cut = edge * m.feed_um / 1000;
    ee += edge * edge;
    ec += edge * cut;
    cc += cut * cut;
    e += edge;
    c += cut;
  }
  const double det = ee * cc - ec * ec;
  // The means of sin² and sin over a turn in which a tooth cuts for half of it are 1/4 and 1/pi.
  const double scale = 1 / (kTeeth * std::sqrt(1 + 0.3 * 0.3));
  const double cut = 4 * scale * (c * ee - e * ec) / det;
  const double edge = M_PI * scale * (e * cc - c * ec) / det;
  return MillingSettings{.cut_n_per_mm2 = {cut, 0.3 * cut, 0},
                         .edge_n_per_mm = {edge, 0.3 * edge, 0}};
}

TEST(SmallFeed, KeepsThePublishedShareOfTheForce) {
  MillingSettings milling = fitted_to_table();
  milling.spindle_rpm = 30000;
  for (const double depth_mm : {0.1, 0.15, 0.2}) {
    const auto computed_n = [&](double feed_um) {
      return length(slot_force_n(milling, feed_um / 1000, depth_mm));
    };
    const double measured = mean_measured_n(0.4, depth_mm) / mean_measured_n(2.4, depth_mm);
    const double computed = computed_n(0.4) / computed_n(2.4);
    EXPECT_NEAR(computed, measured, 0.15 * measured) << depth_mm;
    for (const double feed_um : {0.4, 1.4, 2.4}) {
      const double force_n = mean_measured_n(feed_um, depth_mm);
      EXPECT_NEAR(computed_n(feed_um), force_n, 0.2 * force_n) << depth_mm << ", " << feed_um;
    }
  }
}

/// The mean force in a slot, tangential and radial, per mm of depth.
TEST(SmallFeed, MatchesClosedFormsFrom100Nanometers) {
  MillingSettings linear{.cut_n_per_mm2 = {4000, 1500, 0}, .edge_n_per_mm = {12, 8, 0}};
  for (const double feed_um : {0.1, 0.25, 0.4, 1.0, 3.0}) {
    const Vec3 force = slot_force_n(linear, feed_um / 1000, 0.2) * (M_PI / (kTeeth / 2.0) / 0.2);
    const double half = feed_um / 1000 * M_PI / 2;  // the integral of f sin² over half a turn
    const double across = 4000 * half + 2 * 12, back = 1500 * half + 2 * 8;
    EXPECT_NEAR(force.y, across, 0.03 * across) << feed_um;
    EXPECT_NEAR(force.x, -back, 0.03 * back) << feed_um;
  }
  MillingSettings power{.cut_n_per_mm2 = {300, 100, 0}, .chip_exponents = in_all_directions(0.75)};
  const double of_3_um = length(slot_force_n(power, 0.003, 0.2));
  for (const double feed_um : {0.1, 0.25, 0.4, 1.0}) {
    const double share = std::pow(feed_um / 3, 0.25);
    const double force = length(slot_force_n(power, feed_um / 1000, 0.2));
    EXPECT_NEAR(force / of_3_um, share, 0.03 * share) << feed_um;
  }
}

TEST(SmallFeed, FadesContinuouslyTowardsRest) {
  MillingSettings milling{.cut_n_per_mm2 = {300, 100, 50},
                          .edge_n_per_mm = {12, 8, 3},
                          .chip_exponents = in_all_directions(0.75)};
  double before = length(slot_force_n(milling, 1e-4, 0.2));
  for (const double feed_mm : {5e-5, 2e-5, 5e-6, 1e-6, 1e-7, 1e-8}) {
    const double force = length(slot_force_n(milling, feed_mm, 0.2));
    EXPECT_LT(force, before) << feed_mm;
    before = force;
  }
  EXPECT_LT(before, 3e-4 * length(slot_force_n(milling, 1e-4, 0.2)));
}

}  // namespace
}  // namespace kerf::small_feed_test
