// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "haptic_agent/servo/passivity.h"
#include "haptic_agent/servo/wrench_limiter.h"

namespace kerf::agent {

/// Last stage before the motors: makes the wrench passive, limits it and its rise, and shortens the
/// result to the energy in the account. It comes last because shortening keeps every limit.
template <typename Deficit = CarryDeficit>
class BasicOutputStage {
 public:
  BasicOutputStage(const PassivitySettings& passivity, const WrenchLimits& limits) noexcept
      : passivity_(passivity), limiter_(limits) {}

  /// Accounts for the device's motion since the last tick, at `from_us`. Call it first in each
  /// tick.
  void settle(const Twist& moved, std::uint64_t from_us, std::uint64_t now_us) noexcept {
    passivity_.settle(moved, from_us, now_us);
  }

  /// Returns the wrench to write until the next tick. `velocity`: the filtered estimate; `moved`:
  /// the displacement in the last `dt_s`, which is newer and noisier. The energy must suffice for
  /// both velocities.
  const Wrench& release(const Wrench& requested, const Twist& velocity, const Twist& moved,
                        double dt_s, std::uint64_t now_us) noexcept {
    const Wrench passive = passivity_.project(requested, velocity);
    const Wrench slewed = limiter_.limit(passive, std::min(dt_s, kLongestStepS));
    const double share = passivity_.share(slewed, velocity, now_us);
    released_ = limiter_.shorten(share);
    if (dt_s > 0) {
      released_ = limiter_.shorten(passivity_.share(released_, moved * (1 / dt_s), now_us));
    }
    passivity_.wrote(released_, now_us);
    return released_;
  }
  /// Sets the output to zero at once.
  const Wrench& silence(std::uint64_t now_us) noexcept {
    released_ = limiter_.limit({}, 0);
    passivity_.wrote(released_, now_us);
    return released_;
  }

  void restart() noexcept { passivity_.restart(); }

  const Wrench& released() const noexcept { return released_; }
  const BasicPassivity<Deficit>& passivity() const noexcept { return passivity_; }
  const WrenchLimiter& limiter() const noexcept { return limiter_; }

 private:
  /// Longest time step for slew limiting, so that the force does not jump after a stall.
  static constexpr double kLongestStepS = 0.002;

  BasicPassivity<Deficit> passivity_;
  WrenchLimiter limiter_;
  Wrench released_;
};

using OutputStage = BasicOutputStage<>;

}  // namespace kerf::agent
