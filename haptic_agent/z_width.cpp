// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/z_width.h"

#include <algorithm>
#include <limits>

#include "haptic_agent/device/text_fields.h"
#include "haptic_agent/plain_number.h"
#include "haptic_agent/servo/cut_coupling.h"

namespace kerf::agent {
namespace {

constexpr Vec3 kAxis{0, 0, 1};
constexpr double kMsPerS = 1000, kNSPerMPerNSPerMm = 1000, kGPerKg = 1000;

std::string two_digits(double value) { return plain_number(value, 2); }

/// Returns why a wall across the tip is softer than declared.
std::string reason_of(const DeviceCapabilities& device, const ContactLimits& limits, Vec3 arm_mm) {
  const double mass = moved_mass(limits, arm_mm, {1, 0, 0});
  ContactLimits heavy = limits;
  heavy.mass_kg = 0;
  heavy.max_stiffness = std::numeric_limits<double>::infinity();
  const double by_damping =
      stable_gains(heavy, heavy.max_stiffness, arm_mm, {1, 0, 0}, 1).stiffness;
  if (mass > 0 && by_damping > stable_gains(limits, by_damping, arm_mm, {1, 0, 0}, 1).stiffness) {
    return join({"its tip moves ", two_digits(mass * kGPerKg), " g, and a force acts ",
                 two_digits(limits.force_delay_s * kMsPerS), " ms after its pose"});
  }
  return join({"a damper of ", two_digits(limits.max_damping * kNSPerMPerNSPerMm),
               " N s/m is stable with a delay of ", two_digits(limits.force_delay_s * kMsPerS),
               " ms",
               device.max_damping_n_s_per_mm > 0 ? "" : " (the device declares no damping)"});
}

}  // namespace

ZWidth z_width(const ServoSettings& settings) noexcept {
  const ContactLimits& limits = settings.model.contact;
  const Vec3 arm_mm = kAxis * -settings.pivot_mm;
  return {.along = stable_gains(limits, limits.max_stiffness, arm_mm, kAxis, 1),
          .across = stable_gains(limits, limits.max_stiffness, arm_mm, {1, 0, 0}, 1)};
}

std::string z_width_notice(const DeviceCapabilities& device, const ServoSettings& settings) {
  if (!settings.safety.motors) return {};
  const ZWidth width = z_width(settings);
  const std::string rendered = join({"walls are rendered with up to ",
                                     two_digits(width.along.stiffness), " N/mm along the tool and ",
                                     two_digits(width.across.stiffness), " N/mm across its tip"});
  const double declared = device.max_stiffness_n_per_mm;
  const double least = std::min(width.along.stiffness, width.across.stiffness);
  constexpr double kRendered = 0.99;
  if (!(least < kRendered * declared)) return rendered;
  const Vec3 arm_mm = kAxis * -settings.pivot_mm;
  return join({rendered, "; the declared ", plain_number(declared, 3),
               " N/mm would oscillate: ", reason_of(device, settings.model.contact, arm_mm)});
}

}  // namespace kerf::agent
