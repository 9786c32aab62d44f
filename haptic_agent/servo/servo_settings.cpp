// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "haptic_agent/device/units.h"
#include "haptic_agent/servo/contact_limits.h"
#include "haptic_agent/servo/servo_cycle.h"

namespace kerf::agent {
namespace {

constexpr std::uint64_t kPeriodUs = 1000;
/// Share of a device's stable damping that cuts and the passivity layer may use.
constexpr double kStableShare = 0.5;
/// Greatest share of mass / delay that a damper may have.
constexpr double kDamperShare = 0.25;

/// Sets the gains that follow from the device's mass and latency. Dampers act a latency and a
/// period late, so the least mass limits them.
void adapt_to_mechanics(const DeviceCapabilities& device, ServoSettings& settings) {
  settings.velocity_cutoff_hz =
      velocity_cutoff_hz(device, settings.pivot_mm, settings.velocity_cutoff_hz);
  ContactLimits& contact = settings.model.contact;
  contact = contact_limits(device, settings.velocity_cutoff_hz);
  PassivitySettings& passivity = settings.passivity;
  passivity.latency_us = device.latency_us;
  if (contact.mass_kg > 0) {
    passivity.mass_kg = contact.mass_kg;
    passivity.inertia_kg_m2 = contact.inertia_kg_m2;
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
  if (device.max_damping_n_s_per_mm > 0) {
    settings.model.max_damping = kStableShare * device.max_damping_n_s_per_mm;
    settings.passivity.max_damping = settings.model.max_damping;
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
