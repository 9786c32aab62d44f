// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/servo/contact_limits.h"

#include <algorithm>
#include <numbers>

#include "haptic_agent/device/units.h"

namespace kerf::agent {
namespace {

constexpr double kPeriodS = 1e-3;
/// The velocity filter may delay by the time in which a damper of this strength stops the mass at
/// the tip, N s/m. From 20 g on that is the 1.6 ms of a filter of 100 Hz.
constexpr double kFilterNSPerM = 12.5;
/// Greatest change of a damper's force by one encoder step, N.
constexpr double kEncoderStepN = 0.1;
/// Assumed encoder step of a device that declares none, mm.
constexpr double kUnknownStepMm = 0.02;

double filter_s(double cutoff_hz) { return 1 / (2 * std::numbers::pi * cutoff_hz); }

}  // namespace

double velocity_cutoff_hz(const DeviceCapabilities& device, double pivot_mm,
                          double usual_hz) noexcept {
  const ContactLimits mechanics{.mass_kg = device.moving_mass_kg,
                                .inertia_kg_m2 = device.moving_inertia_kg_m2};
  const double tip_kg = moved_mass(mechanics, {0, 0, -pivot_mm}, {1, 0, 0});
  if (!(tip_kg > 0)) return usual_hz;
  return std::max(usual_hz, 1 / (2 * std::numbers::pi * (tip_kg / kFilterNSPerM)));
}

ContactLimits contact_limits(const DeviceCapabilities& device, double cutoff_hz) noexcept {
  ContactLimits limits;
  const double latency_s = static_cast<double>(device.latency_us) * kSPerUs;
  const double prompt_s = kPeriodS + filter_s(cutoff_hz);
  limits.force_delay_s = latency_s + kPeriodS / 2;
  limits.velocity_delay_s = latency_s + prompt_s;
  if (device.moving_mass_kg > 0 && device.moving_inertia_kg_m2 > 0) {
    limits.mass_kg = device.moving_mass_kg;
    limits.inertia_kg_m2 = device.moving_inertia_kg_m2;
  }
  if (device.max_stiffness_n_per_mm > 0) limits.max_stiffness = device.max_stiffness_n_per_mm;
  if (device.max_damping_n_s_per_mm > 0) {
    const double step_mm = device.resolution_mm > 0 ? device.resolution_mm : kUnknownStepMm;
    limits.max_damping =
        std::min(device.max_damping_n_s_per_mm * prompt_s / limits.velocity_delay_s,
                 kEncoderStepN * prompt_s / step_mm);
  }
  return limits;
}

}  // namespace kerf::agent
