// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <expected>
#include <optional>
#include <string>

#include "haptic_agent/device/haptic_device.h"

namespace kerf::agent {

/// The result of `kerf-agent doctor --identify` for one device. Absent values leave the driver's
/// declaration in force.
struct DeviceProfile {
  /// DeviceCapabilities::name. Empty if not stated.
  std::string device{};
  std::optional<std::uint64_t> latency_us{};
  std::optional<double> resolution_mm{}, resolution_rad{};
  std::optional<double> moving_mass_kg{}, moving_inertia_kg_m2{};
  /// For the user only: Coulomb and viscous friction of the position, and the stiffest walls along
  /// the tool's axis and across its tip.
  double friction_n = 0, viscous_n_s_per_mm = 0;
  double wall_along_n_per_mm = 0, wall_across_n_per_mm = 0;
};

/// Returns why a profile cannot be used for a device, as one sentence with the remedy: it was
/// measured on a device with another name. Empty if it can, or if the profile names no device.
std::string profile_mismatch(const DeviceProfile& profile, const DeviceCapabilities& device);

/// Returns capabilities with the values of a profile in place of the declared ones. A latency below
/// the declared one and resolutions of zero (not found) change nothing: the energy bound holds for
/// the longer latency and the declared step.
DeviceCapabilities with_profile(DeviceCapabilities declared,
                                const std::optional<DeviceProfile>& profile);

/// Reads a profile file (haptic_agent/README.md, "doctor"). The error is one sentence that names
/// the file and the cause.
std::expected<DeviceProfile, std::string> read_profile(const std::string& path);
/// Writes a profile as lines of `name value`, without absent values and resolutions of zero. The
/// error is one sentence.
std::expected<void, std::string> write_profile(const std::string& path,
                                               const DeviceProfile& profile);

}  // namespace kerf::agent
