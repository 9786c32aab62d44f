// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "kernel/math/wrench.h"

namespace kerf::agent {

/// Magnitudes of a gamepad's two motors, as in linux/input.h.
struct RumbleLevel {
  std::uint16_t strong = 0;  ///< the heavy motor, for force
  std::uint16_t weak = 0;    ///< the light motor, for torque

  bool operator==(const RumbleLevel&) const = default;
};

/// Force and torque at which the motors run at full strength.
inline constexpr double kFullRumbleN = 4;
inline constexpr double kFullRumbleNmm = 120;

/// Returns the magnitudes for a wrench, or zero if it is not finite. They follow force and torque
/// rather than power, so a tool that rests against a surface rumbles too.
RumbleLevel rumble_of(const Wrench& wrench) noexcept;

/// Decides when a rumble effect is updated. An update is due at most every kPeriodUs if the level
/// has changed perceptibly, and at once if it becomes zero. A level above zero is renewed every
/// kRenewUs, because an effect ends after kEffectMs.
class RumbleClock {
 public:
  static constexpr std::uint64_t kPeriodUs = 20'000;
  static constexpr std::uint64_t kRenewUs = 100'000;
  static constexpr std::uint16_t kEffectMs = 250;

  /// Returns the level to set now, or nullopt if no update is due.
  std::optional<RumbleLevel> due(const RumbleLevel& level, std::uint64_t now_us) noexcept;
  void restart() noexcept { *this = {}; }

 private:
  RumbleLevel set_;
  std::uint64_t set_us_ = 0;
};

}  // namespace kerf::agent
