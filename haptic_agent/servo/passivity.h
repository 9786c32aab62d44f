// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>

#include "haptic_agent/device/units.h"
#include "haptic_agent/servo/energy_account.h"
#include "haptic_agent/servo/grip.h"
#include "haptic_agent/servo/written_wrenches.h"

namespace kerf::agent {

struct PassivitySettings {
  /// Bound of the net work done on the user over any interval, mJ.
  double tank_mj = 30;
  /// Bound of the error of the work estimate, mJ. Twice this is kept out of the account. It may be
  /// overdrawn by this much before the output is cut off, and by as much again until the cut-off
  /// acts.
  double reserve_mj = 6;
  /// Level at which the account begins, mJ. From zero, the first cut after arming would be felt
  /// only after its own work has filled the account, over millimeters of travel.
  double start_mj = 6;
  /// Greatest damping of the damper that dissipates a deficit: N s/mm, N mm s/rad. The root of
  /// their ratio is the lever arm that weighs rotation against translation, mm.
  double max_damping = 0.01;
  double max_turn_damping = 4;
  /// Below this speed the velocity estimate has no reliable direction, mm/s.
  double speed_floor = 2;
  /// DeviceCapabilities::latency_us.
  std::uint64_t latency_us = 0;
  /// Longest time between two ticks that is tolerated without a trip.
  std::uint64_t longest_tick_us = 5000;
  /// Least mass and inertia that are moved: the lightest device for which the bound is claimed.
  double mass_kg = 0.05;
  double inertia_kg_m2 = 1e-5;
};

/// Keeps the device passive: bounds the energy that it returns to the user, for any requested
/// wrench (derivation in haptic_agent/servo/passivity.md). In each tick: `settle`, then `project`
/// and `share` as needed, then `wrote`.
template <typename Deficit = CarryDeficit>
class BasicPassivity {
 public:
  explicit BasicPassivity(const PassivitySettings& settings) noexcept
      : settings_(settings),
        account_(settings.tank_mj - 2 * settings.reserve_mj, settings.start_mj) {}

  /// Accounts for the displacement between the ticks at `from_us` and `now_us`, by the greatest
  /// work of any written wrench that may have acted.
  void settle(const Twist& moved, std::uint64_t from_us, std::uint64_t now_us) noexcept {
    account_.settle(written_.greatest_work(moved, from_us, now_us, settings_.latency_us));
  }

  /// Returns the wrench nearest to `requested` whose power the account covers while the device
  /// moves with `velocity`. Returns a damper if there is a deficit, zero if overdrawn.
  Wrench project(const Wrench& requested, const Twist& velocity) noexcept {
    if (overdrawn()) return {};
    const double level = account_.level_mj();
    const double dissipated = -work(damper(velocity, 1), velocity);
    if (level < 0) return damper(velocity, std::min(1.0, -level / (dissipated * kTickS + kLeast)));
    const double power = work(requested, velocity);
    const double allowed = level / (kSPerUs * acts_us());
    const double floor = settings_.speed_floor;
    if (power <= allowed || dissipated < settings_.max_damping * floor * floor) return requested;
    ++projected_;
    return requested + damper(velocity, (power - allowed) / dissipated);
  }

  /// Returns the greatest share of `wrench`, 0 to 1, whose work the account covers until it ends,
  /// together with that of the written wrenches that may still act.
  double share(const Wrench& wrench, const Twist& velocity, std::uint64_t now_us) noexcept {
    starving_ = account_.level_mj() < 0;
    if (overdrawn()) return 0;
    const double covered = std::max(account_.level_mj(), cost({}, velocity, now_us));
    if (cost(wrench, velocity, now_us) <= covered) return 1;
    // The cost is convex in the share and covered at zero.
    double low = 0;
    double high = 1;
    for (int i = 0; i < kBisections; ++i) {
      const double middle = (low + high) / 2;
      (cost(wrench * middle, velocity, now_us) <= covered ? low : high) = middle;
    }
    starving_ = starving_ || low < kStarvingShare;
    return low;
  }

  /// Must be called for every wrench that is written to the device.
  void wrote(const Wrench& wrench, std::uint64_t now_us) noexcept {
    written_.write(wrench, now_us);
  }

  /// Resets the account after the user has re-armed the device. The bound holds again from here.
  void restart() noexcept {
    account_ = BasicEnergyAccount<Deficit>(account_.ceiling_mj(), settings_.start_mj);
  }

  const BasicEnergyAccount<Deficit>& account() const noexcept { return account_; }
  /// The account is overdrawn by more than an estimate can err. The output stays zero until
  /// restart.
  bool overdrawn() const noexcept { return account_.level_mj() < -settings_.reserve_mj; }
  /// The last wrench was replaced by a damper or by almost nothing: the energy tank is empty.
  bool starving() const noexcept { return starving_; }
  /// Number of wrenches that were reduced.
  std::uint64_t projected() const noexcept { return projected_; }

 private:
  static constexpr double kTickS = 1e-3;
  static constexpr double kLeast = 1e-12;
  static constexpr double kStarvingShare = 0.05;
  static constexpr int kBisections = 12;

  /// Longest time for which a wrench written now may act, counted from now.
  double acts_us() const noexcept {
    return static_cast<double>(settings_.latency_us + settings_.longest_tick_us);
  }
  /// A damper with the given share of the greatest damping.
  Wrench damper(const Twist& v, double share) const noexcept {
    return {v.linear * (-share * settings_.max_damping),
            v.angular * (-share * settings_.max_turn_damping)};
  }

  /// Upper estimate of the work until `wrench` has ended, mJ. It adds the greatest work, at the
  /// present velocity, of the wrenches that may act at each time, and the energy that `wrench`
  /// gives to the lightest device until the tick after the next, when its effect is measured.
  double cost(const Wrench& wrench, const Twist& velocity, std::uint64_t now_us) const noexcept {
    const double power = work(wrench, velocity);
    double greatest = std::max(0.0, power);
    double sum = 0;
    double last_s = -1;
    written_.for_each_possible(
        now_us, now_us, settings_.latency_us, [&](const Wrench& earlier, std::uint64_t until_us) {
          const double until_s = kSPerUs * static_cast<double>(until_us - now_us);
          if (last_s > 0) sum += (last_s - until_s) * greatest;
          greatest = std::max(greatest, work(earlier, velocity));
          last_s = until_s;
        });
    sum += std::max(0.0, last_s) * greatest;
    const double tick_s = kSPerUs * static_cast<double>(settings_.longest_tick_us);
    return sum + power * (power > 0 ? tick_s : kTickS) + push(wrench);
  }

  /// Energy that a constant wrench gives to the lightest device at rest, mJ.
  double push(const Wrench& wrench) const noexcept {
    const double time_s = kSPerUs * acts_us();
    const Vec3 torque_nm = wrench.torque_nmm * (1 / kNmmPerNm);
    return kMjPerJ / 2 * time_s * time_s *
           (dot(wrench.force_n, wrench.force_n) / settings_.mass_kg +
            dot(torque_nm, torque_nm) / settings_.inertia_kg_m2);
  }

  PassivitySettings settings_;
  BasicEnergyAccount<Deficit> account_;
  WrittenWrenches written_;
  bool starving_ = false;
  std::uint64_t projected_ = 0;
};

using Passivity = BasicPassivity<>;

}  // namespace kerf::agent
