// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "haptic_agent/servo/passivity.h"
#include "haptic_agent/servo/wrench_limiter.h"

namespace kerf::agent {

/// All that stands between a wanted wrench and the motors: passive, within its limits, and passive
/// again, because a wrench that may not rise at once keeps some of its old direction.
template <typename Deficit = CarryDeficit>
class BasicOutputStage {
 public:
  BasicOutputStage(const PassivitySettings& passivity, const WrenchLimits& limits) noexcept
      : passivity_(passivity), limiter_(limits) {}

  /// The hand has moved so since the last release; first in each tick.
  void settle(const Twist& moved) noexcept { passivity_.settle(shown_, moved); }

  /// What to show until the next tick, `dt_s` after the last one.
  const Wrench& release(const Wrench& wanted, const Twist& velocity, double dt_s) noexcept {
    const double step_s = std::min(dt_s, kLongestStepS);
    const Wrench passive = passivity_.admit(wanted, velocity, dt_s);
    const Wrench slewed = limiter_.limit(passive, step_s);
    shown_ = limiter_.fit(passivity_.admit(slewed, velocity, dt_s));
    return shown_;
  }
  /// Nothing, at once.
  const Wrench& silence() noexcept { return shown_ = limiter_.limit({}, 0); }

  void restart() noexcept { passivity_.restart(); }

  const Wrench& shown() const noexcept { return shown_; }
  const BasicPassivity<Deficit>& passivity() const noexcept { return passivity_; }
  const WrenchLimiter& limiter() const noexcept { return limiter_; }

 private:
  /// A step of the wrench is never allowed more rise than this time would give, so that a loop that
  /// stood still does not come back with a jerk.
  static constexpr double kLongestStepS = 0.002;

  BasicPassivity<Deficit> passivity_;
  WrenchLimiter limiter_;
  Wrench shown_;
};

using OutputStage = BasicOutputStage<>;

}  // namespace kerf::agent
