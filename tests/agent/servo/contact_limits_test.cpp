// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/servo/contact_limits.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <numbers>

namespace kerf::agent {
namespace {

constexpr double kTickS = 1e-3;

struct Loop {
  double latency_s, cutoff_hz;
  double filter_s() const { return 1 / (2 * std::numbers::pi * cutoff_hz); }
};

/// Returns how much more a mass on a rendered spring and damper moves after 0.5 s than after 0.1:
/// more than 1 if it oscillates ever more. SI units.
double growth(double mass, double stiffness, double damping, const Loop& loop) {
  constexpr int kSteps = 8, kTicks = 600, kEarly = 100, kLate = 500;
  const double part = kTickS / (loop.filter_s() + kTickS);
  std::deque<std::pair<double, double>> written;
  double x = 1e-3, v = 0, filtered = 0, last = x, acting = 0, time = 0, early = 0, late = 0;
  for (int tick = 0; tick < kTicks; ++tick) {
    filtered += ((x - last) / kTickS - filtered) * part;
    last = x;
    written.emplace_back(time + loop.latency_s, -stiffness * x - damping * filtered);
    for (int n = 0; n < kSteps; ++n, time += kTickS / kSteps) {
      while (!written.empty() && written.front().first <= time + 1e-9) {
        acting = written.front().second;
        written.pop_front();
      }
      v += acting / mass * kTickS / kSteps;
      x += v * kTickS / kSteps;
      const double energy = stiffness * x * x + mass * v * v;
      if (tick >= kEarly && tick < 2 * kEarly) early = std::max(early, energy);
      if (tick >= kLate) late = std::max(late, energy);
    }
  }
  return std::isfinite(late) ? late / early : 1e9;
}

double worst_growth(double mass, double stiffness, double damping, const Loop& loop) {
  double worst = 0;
  for (const double times : {1.0, 1.5, 2.0, 3.0, 5.0, 10.0, 30.0, 100.0, 1000.0})
    worst = std::max(worst, growth(times * mass, stiffness, damping, loop));
  return worst;
}

/// At the gains every mass from the declared one on comes to rest; at 1.5 times the stiffness some
/// mass does not, whatever the damper. So they are at least two thirds of the greatest.
TEST(ContactLimits, AreNearTheLimitOfAFreeMass) {
  constexpr double kMass = 0.05;
  for (const double latency_s : {0.0, 0.001, 0.003}) {
    for (const double cutoff_hz : {100.0, 400.0, 1e6}) {
      const Loop loop{latency_s, cutoff_hz};
      ContactLimits limits{.max_stiffness = 1e9, .max_damping = 1e9};
      limits.mass_kg = kMass;
      limits.inertia_kg_m2 = 1;
      limits.force_delay_s = latency_s + kTickS / 2;
      limits.velocity_delay_s = latency_s + kTickS + loop.filter_s();
      const ContactGains gains = stable_gains(limits, 1e9, {}, {0, 0, 1}, 1);
      const double stiffness = gains.stiffness * 1000, damping = gains.damping * 1000;
      EXPECT_LT(worst_growth(kMass, stiffness, damping, loop), 1) << latency_s << ", " << cutoff_hz;
      double least = 1e9;
      for (double factor = 0.4; factor < 4; factor *= 1.15)
        least = std::min(least, worst_growth(kMass, 1.5 * stiffness, factor * damping, loop));
      EXPECT_GT(least, 1) << latency_s << ", " << cutoff_hz;
    }
  }
}

TEST(ContactLimits, UseTheDeclaredDampingAsFarAsLatencyAndEncoderPermit) {
  DeviceCapabilities device{.max_stiffness_n_per_mm = 14.5, .max_damping_n_s_per_mm = 0.03};
  device.resolution_mm = 0.001;
  EXPECT_NEAR(contact_limits(device, 100).max_damping, 0.03, 1e-12);
  device.latency_us = 1000;
  const double prompt_s = kTickS + 1 / (200 * std::numbers::pi);
  EXPECT_NEAR(contact_limits(device, 100).max_damping, 0.03 * prompt_s / (prompt_s + kTickS),
              1e-12);
  device.resolution_mm = 0.055;
  EXPECT_NEAR(contact_limits(device, 100).max_damping, 0.1 * prompt_s / 0.055, 1e-12)
      << "a step of the encoder changes the velocity by part of 0.055 mm in a tick";
  EXPECT_EQ(contact_limits(device, 100).max_stiffness, 14.5);
}

TEST(ContactLimits, ALightTipGetsAShorterFilter) {
  DeviceCapabilities pen{.moving_mass_kg = 0.05, .moving_inertia_kg_m2 = 1e-5};
  EXPECT_NEAR(velocity_cutoff_hz(pen, 60, 100), 12.5 / (2 * std::numbers::pi * 2.6316e-3), 1);
  pen.moving_mass_kg = 0.3;
  pen.moving_inertia_kg_m2 = 2e-4;
  EXPECT_EQ(velocity_cutoff_hz(pen, 60, 100), 100) << "47 g";
  EXPECT_EQ(velocity_cutoff_hz({}, 60, 100), 100) << "unknown";
}

}  // namespace
}  // namespace kerf::agent
