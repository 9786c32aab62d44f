// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "haptic_agent/device/haptic_device.h"

namespace kerf::agent {

/// Limits of the output wrench and of its rate of rise. Defaults: passivity.md, step 3.
struct WrenchLimits {
  double force_n = 8.0;
  double torque_nmm = 150.0;
  double force_rise_n_per_s = 400.0;
  double torque_rise_nmm_per_s = 8000.0;
};

/// Reduces `limits` to kDeviceShare of the device's maximum. A device without motors is not
/// limited.
WrenchLimits within(const DeviceCapabilities& device, WrenchLimits limits);

/// Share of a device's maximum force and torque that is used.
inline constexpr double kDeviceShare = 0.6;

/// Limits force and torque. A wrench that exceeds a limit is shortened as a whole, which keeps its
/// screw axis. The rise of force and torque is rate-limited, their fall is not. A wrench that is
/// not finite gives zero.
class WrenchLimiter {
 public:
  explicit WrenchLimiter(const WrenchLimits& limits) noexcept : limits_(limits) {}

  /// Returns the wrench to output `dt_s` after the last one.
  Wrench limit(const Wrench& requested, double dt_s) noexcept;

  /// Shortens the current output to a share of itself, 0 to 1, and returns it. This keeps all
  /// limits and rates, so it may be called at any time.
  Wrench shorten(double share) noexcept;

  std::uint64_t saturated() const noexcept { return saturated_; }
  std::uint64_t slewed() const noexcept { return slewed_; }
  std::uint64_t not_finite() const noexcept { return not_finite_; }

 private:
  WrenchLimits limits_;
  Wrench output_;
  std::uint64_t saturated_ = 0;
  std::uint64_t slewed_ = 0;
  std::uint64_t not_finite_ = 0;
};

}  // namespace kerf::agent
