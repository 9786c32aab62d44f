// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>

#include "haptic_agent/servo/contact_model.h"
#include "haptic_agent/servo/grip_history.h"

namespace kerf::agent {

/// Returns the limits of a device for the force of a cut. Softer than for contacts: half of the
/// stiffness, and damping of at most 4 N s/m. A cut that is coupled more stiffly shakes soft hands
/// (found by trial, `felt_bench hands`).
ContactLimits cut_limits(ContactLimits contact) noexcept;

/// Returns the gains of the coupling of a cut across the arm from pivot to cut, where a push moves
/// least mass: a damper of half of that mass over its delay, with the filter of 100 Hz, and a
/// spring of 0.8 of damper / delay.
ContactGains gains_across(const ContactLimits& limits, Vec3 arm_mm) noexcept;

/// Watches whether a force drives the trembling of a point or brakes it. Trembling: what varies
/// faster than a hand moves willingly, above about 16 Hz.
class Trembling {
 public:
  /// Takes the force that acted over the last `dt_s`, and the displacement in that time.
  void take(Vec3 force_n, Vec3 moved_mm, double dt_s) noexcept;
  /// Mean power over what force and speed could have at most, -1 (brakes) to 1 (drives). Trembling
  /// of less than about 1 mm/s counts little.
  double driven() const noexcept;
  /// Whether it has become stronger over the last hundredths of a second.
  bool grows() const noexcept;
  /// Whether the point swings to and fro: its velocity has reversed twice, each time within half a
  /// period of the slowest trembling. The onset of a stroke and its end change velocity and force
  /// once; trembling does so again and again.
  bool swings() const noexcept { return reversals_ >= kReversals; }
  /// Displacement over force, rms, mm/N.
  double compliance() const noexcept;

 private:
  /// What varies fast of a vector: two high passes of first order.
  struct Fast {
    Vec3 mean{}, mean_of_rest{};
    Vec3 take(Vec3 value, double part) noexcept;
  };
  void count_reversals(Vec3 velocity, double dt_s) noexcept;

  static constexpr int kReversals = 2;

  Fast force_, velocity_;
  /// The greatest fast velocity since it reversed last, the time since then, and how often it has.
  Vec3 peak_{};
  double since_s_ = 0;
  int reversals_ = 0;
  double power_ = 0, force_square_ = 0, speed_square_ = 0, earlier_square_ = 0;
};

/// Couples the device to the force of a cut as softly as the hand requires.
///
/// A cut opposes the motion at any speed, so it brakes every trembling of the tool. Rendered late,
/// the force of a tool that trembles in a hand that yields may drive it instead: it chatters. No
/// chatter can last unless the force drives it. So the power that the force puts into the trembling
/// is measured; while it is positive and the trembling grows, the compliance c grows, mm/N, and the
/// rendered wrench F follows the computed one over F c of the path of the tool, as if through an
/// elastic tool of stiffness 1 / c, after it was turned with the heading. Otherwise c falls slowly.
/// In a hand that does not yield it is zero, and the wrench is the computed one. At most, it is as
/// soft as the device alone renders it stably (stable_gains), or as `least_most_mm_per_n`. All
/// components of the wrench are scaled and turned together.
///
/// A tool that turned back in its cut cuts nothing, and its computed force ends. Where c is not
/// zero, the elastic tool holds it there: moved to and fro, it is unloaded and loaded again by 1 /
/// c as far as to the force at which it turned back, and damped as the device renders it stably,
/// like a body at rest in dry friction. Beyond that force, or once it is slack, the tool slips.
class CutCoupling {
 public:
  /// `least_most_mm_per_n`: compliance up to which it may grow whatever the device renders.
  explicit CutCoupling(const ContactLimits& limits, double least_most_mm_per_n = 0) noexcept;

  /// Returns the wrench to render instead of `target` at the newest grip, `dt_s` after the last.
  /// `arm_mm`: from the pivot to the middle of the cut.
  Wrench at(const Wrench& target, Vec3 arm_mm, const PastGrip& now, double dt_s) noexcept;
  /// Forgets the force of the cut; call it in each tick without one. The compliance falls there
  /// too, and the motion is watched on, so that the next cut begins as its own trembling requires.
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
  /// As LocalModel::heading, over the path over which the force follows.
  Vec3 heading_{};
  Grip grip_{};
  bool has_grip_ = false;
  /// The last forces; the one that acted was rendered `latency_ticks_` before the newest.
  std::array<Vec3, kKept> forces_{};
  std::size_t newest_ = 0, latency_ticks_ = 0;
};

}  // namespace kerf::agent
