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
  std::string device{};
  std::optional<std::uint64_t> latency_us{};
  std::optional<double> resolution_mm{}, resolution_rad{};
  std::optional<double> moving_mass_kg{}, moving_inertia_kg_m2{};
  /// For the user; the agent does not use them: friction of position, and stiffest walls.
  double friction_n = 0, viscous_n_s_per_mm = 0;
  double wall_along_n_per_mm = 0, wall_across_n_per_mm = 0;
};

/// Returns capabilities with the values of a profile in place of those declared.
DeviceCapabilities with_profile(DeviceCapabilities declared,
                                const std::optional<DeviceProfile>& profile);

/// Reads a profile file (haptic_agent/README.md, "doctor"). The error is one sentence that names
/// the file and the cause.
std::expected<DeviceProfile, std::string> read_profile(const std::string& path);
/// Writes one, as a text of `name value` lines; the error is one sentence.
std::expected<void, std::string> write_profile(const std::string& path,
                                               const DeviceProfile& profile);

}  // namespace kerf::agent
