// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "haptic_agent/device/haptic_device.h"

namespace kerf::agent {

/// What the hand may be given. Defaults after the safety envelope of the README.
struct WrenchLimits {
  double force_n = 8.0;
  double torque_nmm = 150.0;
  double force_rise_n_per_s = 400.0;
  double torque_rise_nmm_per_s = 8000.0;
};

/// Limits at most to `share` of what the device can give; a device without motors is not limited.
WrenchLimits within(const DeviceCapabilities& device, WrenchLimits limits);

/// Share of a device's greatest force that is used.
inline constexpr double kDeviceShare = 0.6;

/// The last gate before the motors. Force and torque are each shortened to their greatest length
/// without changing direction; their rise is limited while their fall is not; a number that is not
/// finite gives nothing at all.
class WrenchLimiter {
 public:
  explicit WrenchLimiter(const WrenchLimits& limits) noexcept : limits_(limits) {}

  /// The wrench to show `dt_s` after the last one.
  Wrench limit(const Wrench& wanted, double dt_s) noexcept;

  /// Force and torque shortened alike, so that neither is above its most; remembered as shown. What
  /// does no work before does none after.
  Wrench fit(const Wrench& wanted) noexcept;

  std::uint64_t saturated() const noexcept { return saturated_; }
  std::uint64_t slewed() const noexcept { return slewed_; }
  std::uint64_t not_finite() const noexcept { return not_finite_; }

 private:
  WrenchLimits limits_;
  Wrench shown_;
  std::uint64_t saturated_ = 0;
  std::uint64_t slewed_ = 0;
  std::uint64_t not_finite_ = 0;
};

}  // namespace kerf::agent
