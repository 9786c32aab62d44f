// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <expected>
#include <optional>
#include <string>

#include "haptic_agent/device/haptic_device.h"

namespace kerf::agent {

/// The result of `kerf-agent doctor --identify` for one device. An absent value does not override
/// the driver's declaration.
struct DeviceProfile {
  /// DeviceCapabilities::name; empty: not stated.
  std::string device{};
  std::optional<std::uint64_t> latency_us{};
  std::optional<double> resolution_mm{}, resolution_rad{};
  std::optional<double> moving_mass_kg{}, moving_inertia_kg_m2{};
  /// For the user; the agent does not use them: Coulomb and viscous friction of the position, and
  /// the stiffest walls along the tool's axis and across its tip.
  double friction_n = 0, viscous_n_s_per_mm = 0;
  double wall_along_n_per_mm = 0, wall_across_n_per_mm = 0;
};

/// Returns why a profile does not belong to a device, as one sentence with the remedy: it was
/// measured on a device of another name. Empty if it belongs, or names no device.
std::string profile_mismatch(const DeviceProfile& profile, const DeviceCapabilities& device);

/// Returns capabilities with the values of a profile in place of those declared. A latency that is
/// shorter than the declared one, and resolutions of zero (none found), change nothing: the
/// energy bound holds for the longer latency and the declared step.
DeviceCapabilities with_profile(DeviceCapabilities declared,
                                const std::optional<DeviceProfile>& profile);

/// Reads a profile file (haptic_agent/README.md, "doctor"). The error is one sentence that names
/// the file and the cause.
std::expected<DeviceProfile, std::string> read_profile(const std::string& path);
/// Writes one, as a text of `name value` lines, without absent values and resolutions of zero; the
/// error is one sentence.
std::expected<void, std::string> write_profile(const std::string& path,
                                               const DeviceProfile& profile);

}  // namespace kerf::agent
