// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <numbers>

#include "haptic_agent/device/units.h"
#include "haptic_agent/servo/servo_cycle.h"

namespace kerf::agent {
namespace {

constexpr double kSecondsPerUs = 1e-6;
constexpr std::uint64_t kPeriodUs = 1000;
/// Share of a device's stable stiffness and damping that is used.
constexpr double kStableShare = 0.5;
/// Share of mass / delay up to which a damper may be set.
constexpr double kDamperShare = 0.25;
constexpr double kTickS = 1e-3;

/// Gains that follow from the device's mass and latency: those of the dampers act a latency and a
/// period late, and what they may take from the least mass in that time is limited.
void adapt_to_mechanics(const DeviceCapabilities& device, ServoSettings& settings) {
  const double latency_s = static_cast<double>(device.latency_us) * kSecondsPerUs;
  const double filter_s = 1 / (2 * std::numbers::pi * settings.velocity_cutoff_hz);
  ContactLimits& contact = settings.model.contact;
  contact.force_delay_s = latency_s + kTickS;
  contact.velocity_delay_s = latency_s + kTickS + filter_s;
  PassivitySettings& passivity = settings.passivity;
  passivity.latency_us = device.latency_us;
  if (device.moving_mass_kg > 0 && device.moving_inertia_kg_m2 > 0) {
    contact.mass_kg = passivity.mass_kg = device.moving_mass_kg;
    contact.inertia_kg_m2 = passivity.inertia_kg_m2 = device.moving_inertia_kg_m2;
  }
  const double stable_per_s = kDamperShare / contact.velocity_delay_s;
  passivity.max_damping =
      std::min(passivity.max_damping, stable_per_s * passivity.mass_kg / kMmPerM);
  passivity.max_turn_damping =
      std::min(passivity.max_turn_damping, stable_per_s * passivity.inertia_kg_m2 * kNmmPerNm);
}

}  // namespace

ServoSettings settings_for(const DeviceCapabilities& device, ServoSettings settings) {
  settings.limits = within(device, settings.limits);
  if (device.max_stiffness_n_per_mm > 0) {
    settings.model.contact.max_stiffness = kStableShare * device.max_stiffness_n_per_mm;
  }
  if (device.max_damping_n_s_per_mm > 0) {
    settings.model.max_damping = kStableShare * device.max_damping_n_s_per_mm;
    settings.passivity.max_damping = settings.model.max_damping;
    settings.model.contact.max_damping =
        std::min(settings.model.contact.max_damping, settings.model.max_damping);
  }
  settings.model.max_vibration_hz = device.max_vibration_hz;
  settings.resolution_mm = device.resolution_mm;
  settings.resolution_rad = device.resolution_rad;
  adapt_to_mechanics(device, settings);
  settings.passivity.longest_tick_us = settings.safety.lost_in_a_row * kPeriodUs;
  settings.safety.continuous_force_n = device.continuous_force_n;
  settings.safety.continuous_torque_nmm = device.continuous_torque_nmm;
  settings.safety.workspace_min_mm = device.workspace_min_mm;
  settings.safety.workspace_max_mm = device.workspace_max_mm;
  settings.safety.has_deadman = device.has_deadman;
  settings.safety.motors = device.max_force_n > 0;
  settings.always_cut = settings.always_cut || device.always_cut;
  return settings;
}

}  // namespace kerf::agent
