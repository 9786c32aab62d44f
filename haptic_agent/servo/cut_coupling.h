// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>

#include "haptic_agent/servo/contact_model.h"
#include "haptic_agent/servo/grip_history.h"

namespace kerf::agent {

/// Returns the limits of a device for the force of a cut: half of the stiffness of contacts, and
/// damping of at most 4 N s/m. Stiffer coupling shakes soft hands (found by trial, `felt_bench
/// hands`).
ContactLimits cut_limits(ContactLimits contact) noexcept;

/// Returns the gains of the coupling of a cut across the arm from pivot to cut, where a push moves
/// the least mass: a damper of half of that mass over its delay, with the filter of 100 Hz, and a
/// spring of 0.8 of damper / delay.
ContactGains gains_across(const ContactLimits& limits, Vec3 arm_mm) noexcept;

/// Detects whether a force drives or brakes the trembling of a point. Trembling is motion above
/// about 16 Hz, faster than a hand moves voluntarily. A lasting oscillation loses energy in the
/// hand, so a force must supply it.
class Trembling {
 public:
  /// Adds the force that acted over the last `dt_s` and the displacement in that time.
  void take(Vec3 force_n, Vec3 moved_mm, double dt_s) noexcept;
  /// Mean power relative to the greatest that force and speed permit, -1 (brakes) to 1 (drives).
  /// Trembling of less than about 1 mm/s counts little.
  double driven() const noexcept;
  /// Whether trembling has increased over the last hundredths of a second.
  bool grows() const noexcept;
  /// Whether the point oscillates: its velocity has reversed twice, each time within half a period
  /// of the slowest trembling. The start or end of a stroke changes velocity and force only once.
  bool swings() const noexcept { return reversals_ >= kReversals; }
  /// Displacement over force, rms, mm/N.
  double compliance() const noexcept;

 private:
  /// The fast part of a vector: two first-order high passes.
  struct Fast {
    Vec3 mean{}, mean_of_rest{};
    Vec3 take(Vec3 value, double part) noexcept;
  };
  void count_reversals(Vec3 velocity, double dt_s) noexcept;

  static constexpr int kReversals = 2;

  Fast force_, velocity_;
  /// Greatest fast velocity since its last reversal, the time since then, and the number of
  /// reversals.
  Vec3 peak_{};
  double since_s_ = 0;
  int reversals_ = 0;
  double power_ = 0, force_square_ = 0, speed_square_ = 0, earlier_square_ = 0;
};

/// Couples the device to the force of a cut as softly as the hand requires.
///
/// A cut opposes motion at any speed v, so to lateral motion it is a damper of F/v: 50 N s/m at 1 N
/// and 20 mm/s. The tip of a pen of 1e-5 kg m^2 has 2.8 g at 60 mm from the pivot and renders that
/// damper only if it acts within m v/F = 0.06 ms; one of 2e-4 kg m^2 and 0.3 kg (47 g), within 1
/// ms. Answers are 1 to 2 ms old, act a latency later, and one field of rays delivers a cut over
/// two pitches of travel. In a hand that yields, the force may therefore drive the trembling that
/// it should brake, and the tool chatters.
///
/// Chatter lasts only if the force drives it. While Trembling detects that and the trembling grows,
/// the compliance c grows, mm/N, from the tremor's displacement over force. The rendered wrench F
/// is turned with the heading and follows the computed one over F c of the tool's path, like that
/// of an elastic tool of stiffness 1 / c. Otherwise c falls slowly. In a hand that does not yield,
/// c is zero and the wrench is the computed one. All components of the wrench are scaled and turned
/// together.
///
/// An elastic tool that acts t late drives like a damper of -t / c, so 1 / c need not be below the
/// stiffness K of gains_across. The wrench follows laterally by 1 / c and its heading by 2 / c, so
/// c is at most 3 / K (7 mm/N for the lightest pen without latency, 20 at 1 ms, 64 at 3 ms), or
/// `least_most_mm_per_n` if that is more.
///
/// A tool that a soft hand draws against its cut comes to rest, its computed force ends, the hand
/// draws on, and so on. If c is not zero, the elastic tool therefore holds a tool that turned back:
/// motion unloads and loads it by 1 / c, up to the force at which it turned back, like a body at
/// rest in dry friction (the bristles of Dahl's and LuGre's models). The damping is D of
/// gains_across, or D c K where 1 / c is stiffer than K, so that it begins without a step. Beyond
/// that force, or once slack, the tool slips.
///
/// Not covered: trembling below 16 Hz, which slow strokes in soft hands have; stick-slip of a tool
/// drawn from rest; a hand that yields by more than the radius of its path. Where the law computes
/// nothing in the first tenths of a millimeter and then twice the holding force, a tip held less
/// stiffly (0.004 to 0.03 N/mm) than the rendered force falls (1 / c, 0.14 N/mm for the lightest
/// pen) slips by 0.6 to 2 mm; 3 / K is the softest stable coupling.
class CutCoupling {
 public:
  /// `least_most_mm_per_n`: compliance that is permitted whatever the device renders.
  explicit CutCoupling(const ContactLimits& limits, double least_most_mm_per_n = 0) noexcept;

  /// Returns the wrench to render instead of `target` at the newest grip, `dt_s` after the last
  /// call. `arm_mm`: from the pivot to the middle of the cut.
  Wrench at(const Wrench& target, Vec3 arm_mm, const PastGrip& now, double dt_s) noexcept;
  /// Forgets the force of the cut. Call it in each tick without a cut. The compliance falls here
  /// too, and the motion is still observed, so that the next cut starts with the compliance that
  /// its trembling requires.
  void release(Vec3 arm_mm, const PastGrip& now, double dt_s) noexcept;
  double compliance_mm_per_n() const noexcept { return compliance_; }

 private:
  Vec3 follow(Vec3 arm_mm, const PastGrip& now) noexcept;
  bool hold(const Wrench& target, Vec3 moved_mm) noexcept;
  double held_n(double target_n, double back_mm) const noexcept;
  double damping_at_rest(Vec3 arm_mm) const noexcept;
  void adapt(Vec3 moved_mm, Vec3 arm_mm, double dt_s) noexcept;
  Vec3 turn(Vec3 moved_mm, double memory_mm) noexcept;
  void remember(Vec3 force_n) noexcept;

  static constexpr std::size_t kKept = 32;

  ContactLimits limits_;
  double least_most_;
  double compliance_ = 0;
  Trembling trembling_;
  /// About the middle of the cut.
  Wrench rendered_;
  /// Whether the elastic tool holds the tool at rest, and the force at which it last slipped.
  bool held_ = false;
  Vec3 slipped_n_{};
  /// Like LocalModel::heading, over the path over which the force follows.
  Vec3 heading_{};
  Grip grip_{};
  bool has_grip_ = false;
  /// The last forces. The one that acted was rendered `latency_ticks_` before the newest.
  std::array<Vec3, kKept> forces_{};
  std::size_t newest_ = 0, latency_ticks_ = 0;
};

}  // namespace kerf::agent
