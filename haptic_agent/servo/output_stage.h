// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "haptic_agent/servo/passivity.h"
#include "haptic_agent/servo/wrench_limiter.h"

namespace kerf::agent {

/// Last stage before the motors: makes the wrench passive, limits it, and makes it passive again,
/// because a slew-limited wrench keeps part of its previous direction.
template <typename Deficit = CarryDeficit>
class BasicOutputStage {
 public:
  BasicOutputStage(const PassivitySettings& passivity, const WrenchLimits& limits) noexcept
      : passivity_(passivity), limiter_(limits) {}

  /// Accounts for the device's motion since the last release. Call it first in each tick.
  void settle(const Twist& moved) noexcept { passivity_.settle(released_, moved); }

  /// Returns the wrench to write until the next tick, `dt_s` after the last one.
  const Wrench& release(const Wrench& requested, const Twist& velocity, double dt_s) noexcept {
    const double step_s = std::min(dt_s, kLongestStepS);
    const Wrench passive = passivity_.admit(requested, velocity, dt_s);
    const Wrench slewed = limiter_.limit(passive, step_s);
    released_ = limiter_.fit(passivity_.admit(slewed, velocity, dt_s));
    return released_;
  }
  /// Sets the output to zero at once.
  const Wrench& silence() noexcept { return released_ = limiter_.limit({}, 0); }

  void restart() noexcept { passivity_.restart(); }

  const Wrench& released() const noexcept { return released_; }
  const BasicPassivity<Deficit>& passivity() const noexcept { return passivity_; }
  const WrenchLimiter& limiter() const noexcept { return limiter_; }

 private:
  /// Upper limit of the time step for slew limiting, so that the force does not jump after a stall.
  static constexpr double kLongestStepS = 0.002;

  BasicPassivity<Deficit> passivity_;
  WrenchLimiter limiter_;
  Wrench released_;
};

using OutputStage = BasicOutputStage<>;

}  // namespace kerf::agent
