// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "haptic_agent/servo/energy_account.h"
#include "haptic_agent/servo/twist.h"

namespace kerf::agent {

struct PassivitySettings {
  /// The promise: over any interval, no more than this is given to the hand. mJ.
  double tank_mj = 30;
  /// The most that one tick's estimate of the hand's motion may be wrong by, mJ. Twice this is kept
  /// out of the account: it may be overdrawn by as much before nothing is shown any more, and one
  /// tick goes by until that is seen.
  double reserve_mj = 6;
  /// Greatest damping of the pure damper that works off a deficit, N s/mm.
  double damping_most = 0.02;
  /// Below this speed the estimate says nothing about where the hand goes, mm/s.
  double speed_floor = 2;
};

/// Weights a turn against a move: the length in M = diag(1, l²), mm. If it grows, the projection
/// takes more from the torque.
inline constexpr double kMetricArmMm = 50;

/// Lets through of any wrench, whoever asks for it, only what cannot make the hand's device a
/// source of energy (derivation in haptic_agent/README.md). One call of `settle` and one or more of
/// `admit` a tick.
template <typename Deficit = CarryDeficit>
class BasicPassivity {
 public:
  explicit BasicPassivity(const PassivitySettings& settings) noexcept
      : settings_(settings), account_(settings.tank_mj - 2 * settings.reserve_mj) {}

  /// `shown` has acted since the last tick, while the hand moved so. A wrench held constant does
  /// exactly this work, whatever the way.
  void settle(const Wrench& shown, const Twist& moved) noexcept {
    account_.settle(work(shown, moved));
  }

  /// The wrench nearest to `wanted` (in M) that the account covers for the next `dt_s` if the hand
  /// goes on moving with `velocity`.
  Wrench admit(const Wrench& wanted, const Twist& velocity, double dt_s) noexcept {
    const double square = squared(velocity);
    const double level = account_.level_mj();
    starving_ = overdrawn();
    if (overdrawn()) return {};
    if (square < settings_.speed_floor * settings_.speed_floor) {
      starving_ = level <= 0 && wanted != Wrench{};
      return level > 0 ? wanted : Wrench{};
    }
    const double allowed = level / dt_s;
    if (level < 0) {
      starving_ = true;
      const double most = settings_.damping_most;
      return damper(velocity, std::min(most, -allowed / square));
    }
    const double power = work(wanted, velocity);
    if (power <= allowed) return wanted;
    ++projected_;
    return wanted + damper(velocity, (power - allowed) / square);
  }

  /// The user has taken note and starts anew: the promise holds from here on.
  void restart() noexcept { account_ = BasicEnergyAccount<Deficit>(account_.ceiling_mj()); }

  const BasicEnergyAccount<Deficit>& account() const noexcept { return account_; }
  /// The account is overdrawn by more than an estimate can be wrong; nothing is shown until
  /// restart.
  bool overdrawn() const noexcept { return account_.level_mj() < -settings_.reserve_mj; }
  /// The last wrench was rejected for want of energy.
  bool starving() const noexcept { return starving_; }
  /// Wrenches of which a part was taken.
  std::uint64_t projected() const noexcept { return projected_; }

 private:
  /// V^T M V.
  static double squared(const Twist& v) noexcept {
    return dot(v.linear, v.linear) + kMetricArmMm * kMetricArmMm * dot(v.angular, v.angular);
  }
  /// -damping M V.
  static Wrench damper(const Twist& v, double damping) noexcept {
    return {v.linear * -damping, v.angular * (-damping * kMetricArmMm * kMetricArmMm)};
  }

  PassivitySettings settings_;
  BasicEnergyAccount<Deficit> account_;
  bool starving_ = false;
  std::uint64_t projected_ = 0;
};

using Passivity = BasicPassivity<>;

}  // namespace kerf::agent
