// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "haptic_agent/servo/energy_account.h"
#include "haptic_agent/servo/grip.h"

namespace kerf::agent {

struct PassivitySettings {
  /// Bound of the net work done on the user over any interval, mJ.
  double tank_mj = 30;
  /// Bound of the error of one tick's work estimate, mJ. Twice this is kept out of the account: it
  /// may be overdrawn by this much before the output is cut off, and by as much again within the
  /// tick in which that is detected.
  double reserve_mj = 6;
  /// Maximum damping of the damper that dissipates a deficit, N s/mm.
  double max_damping = 0.02;
  /// Below this speed the velocity estimate has no reliable direction, mm/s.
  double speed_floor = 2;
};

/// Weight of rotation against translation: the length l in the metric M = diag(1, l²), mm. If it
/// grows, the projection takes more from the torque.
inline constexpr double kMetricArmMm = 50;

/// Projects any requested wrench onto the set that keeps the device passive (derivation in
/// haptic_agent/servo/README.md). Call `settle` once and `admit` one or more times per tick.
template <typename Deficit = CarryDeficit>
class BasicPassivity {
 public:
  explicit BasicPassivity(const PassivitySettings& settings) noexcept
      : settings_(settings), account_(settings.tank_mj - 2 * settings.reserve_mj) {}

  /// Accounts for the work of `output`, which has acted since the last tick while the device moved
  /// by `moved`. For a constant wrench this is exact and does not depend on the path.
  void settle(const Wrench& output, const Twist& moved) noexcept {
    account_.settle(work(output, moved));
  }

  /// Returns the wrench nearest to `requested` (in M) that the account covers for the next `dt_s`
  /// if the device keeps moving with `velocity`.
  Wrench admit(const Wrench& requested, const Twist& velocity, double dt_s) noexcept {
    const double square = squared(velocity);
    const double level = account_.level_mj();
    starving_ = overdrawn();
    if (overdrawn()) return {};
    if (square < settings_.speed_floor * settings_.speed_floor) {
      starving_ = level <= 0 && requested != Wrench{};
      return level > 0 ? requested : Wrench{};
    }
    const double allowed = level / dt_s;
    if (level < 0) {
      starving_ = true;
      const double most = settings_.max_damping;
      return damper(velocity, std::min(most, -allowed / square));
    }
    const double power = work(requested, velocity);
    if (power <= allowed) return requested;
    ++projected_;
    return requested + damper(velocity, (power - allowed) / square);
  }

  /// Resets the account after the user has re-armed the device; the bound holds again from here.
  void restart() noexcept { account_ = BasicEnergyAccount<Deficit>(account_.ceiling_mj()); }

  const BasicEnergyAccount<Deficit>& account() const noexcept { return account_; }
  /// The account is overdrawn by more than an estimate can err; the output stays zero until
  /// restart.
  bool overdrawn() const noexcept { return account_.level_mj() < -settings_.reserve_mj; }
  /// The last wrench was rejected or replaced by a damper: the energy tank is empty.
  bool starving() const noexcept { return starving_; }
  /// Number of wrenches that were reduced.
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
