// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/servo/contact_limits.h"

#include "tests/agent/servo/late_spring.h"
#include "tests/support/test.h"

namespace kerf::agent::contact_limits_test {
namespace {

/// Limits of a mass on a loop, with dampers of at most `max_damping`, N s/mm.
ContactLimits limits_of(double mass_kg, const LateLoop& loop, double max_damping) {
  return {.max_stiffness = 1e9,
          .max_damping = max_damping,
          .mass_kg = mass_kg,
          .inertia_kg_m2 = 1,
          .force_delay_s = loop.latency_s + kTickS / 2,
          .velocity_delay_s = loop.latency_s + kTickS + loop.filter_s()};
}

const std::vector<LateLoop> kLoops = [] {
  std::vector<LateLoop> loops;
  for (const double latency_s : {0.0, 0.001, 0.003})
    for (const double cutoff_hz : {100.0, 400.0, 1e6}) loops.push_back({latency_s, cutoff_hz});
  return loops;
}();

/// With the gains, every mass from the declared one on comes to rest. At 1.5 times the stiffness
/// some mass does not, whatever the damper. So the gains are at least two thirds of the greatest.
TEST(ContactLimits, AreNearTheLimitOfAFreeMass) {
  constexpr double kMass = 0.05;
  for (const LateLoop& loop : kLoops) {
    const ContactGains gains = stable_gains(limits_of(kMass, loop, 1e9), 1e9, {}, {0, 0, 1}, 1);
    const double stiffness = gains.stiffness * 1000, damping = gains.damping * 1000;
    EXPECT_LT(worst_growth(kMass, stiffness, damping, loop), 1)
        << loop.latency_s << ", " << loop.cutoff_hz;
    double least = 1e9;
    for (double factor = 0.4; factor < 4; factor *= 1.15)
      least = std::min(least, worst_growth(kMass, 1.5 * stiffness, factor * damping, loop));
    EXPECT_GT(least, 1) << loop.latency_s << ", " << loop.cutoff_hz;
  }
}

TEST(ContactLimits, MassComesToRestWithAWeakerDamper) {
  constexpr double kMass = 0.05;
  for (const LateLoop& loop : kLoops) {
    const double best = best_damping(limits_of(kMass, loop, 1e9), kMass / 1000);
    for (double share = 1; share > 0.1; share *= 0.85) {
      const ContactLimits limits = limits_of(kMass, loop, share * best);
      const ContactGains gains = stable_gains(limits, 1e9, {}, {0, 0, 1}, 1);
      EXPECT_LT(worst_growth(kMass, gains.stiffness * 1000, gains.damping * 1000, loop), 1)
          << loop.latency_s << ", " << loop.cutoff_hz << ", share " << share;
    }
  }
}

TEST(ContactLimits, UseTheDeclaredDampingWithinLatencyAndEncoderLimits) {
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

TEST(ContactLimits, LightTipGetsAShorterFilter) {
  DeviceCapabilities pen{.moving_mass_kg = 0.05, .moving_inertia_kg_m2 = 1e-5};
  EXPECT_NEAR(velocity_cutoff_hz(pen, 60, 100), 12.5 / (2 * std::numbers::pi * 2.6316e-3), 1);
  pen.moving_mass_kg = 0.3;
  pen.moving_inertia_kg_m2 = 2e-4;
  EXPECT_EQ(velocity_cutoff_hz(pen, 60, 100), 100) << "47 g";
  EXPECT_EQ(velocity_cutoff_hz({}, 60, 100), 100) << "unknown";
}

}  // namespace
}  // namespace kerf::agent::contact_limits_test
