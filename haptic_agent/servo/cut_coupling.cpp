// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/servo/cut_coupling.h"

#include <algorithm>
#include <cmath>

#include "haptic_agent/device/units.h"

namespace kerf::agent {
namespace {

constexpr double kDelayTickS = 0.001;
constexpr double kPeriodShare = 0.75;
/// Coupling of a cut (cut_limits, gains_across): share of the stiffness, damping in N s/mm, and the
/// time constant of the 100 Hz filter.
constexpr double kCutStiffnessShare = 0.5, kCutDamping = 0.004;
constexpr double kMassShare = 0.5, kSpringShare = 0.8, kFilterS = 0.00159;
/// Time constants: of the high passes (16 Hz), of the means of power and squares, and of the
/// earlier mean to which trembling is compared.
constexpr double kFastS = 0.01;
constexpr double kMeanS = 0.015;
constexpr double kEarlierS = 0.03;
/// Trembling grows if its mean square exceeds the earlier one by this ratio.
constexpr double kGrows = 1.2;
/// Speed below which trembling counts little, mm/s: encoder steps of a few micrometers cause as
/// much.
constexpr double kLeastSpeed = 1;
/// Longest time between two reversals of trembling, and the share of the last peak that the
/// opposite velocity must reach to count as a reversal. The filters respond to a single change of
/// velocity with a peak and 0.14 of it in the opposite direction.
constexpr double kHalfPeriodS = 0.08;
constexpr double kReversed = 0.4;
/// Share of the greatest power from which on a force counts as driving. A force that is a quarter
/// of a period late has a share of zero, and noise has less than this.
constexpr double kDriven = 0.2;
/// Time constants in which the compliance grows by a factor e while the force only drives, and
/// falls by it. Corners of a path of short segments look like trembling for some ticks.
constexpr double kGrowS = 0.01;
constexpr double kFallS = 0.2;
/// The heading that turns the force follows over this share of the force's own path. Over a longer
/// path it would lag on a circle; without one it would tremble with the tool.
constexpr double kHeadingShare = 0.5;
/// Laterally, the force follows by 1 / c and its heading by two more; together they must stay
/// within the stiffness that the device renders stably.
constexpr double kStiffnesses = 1 + 1 / kHeadingShare;
/// Trembling beyond this multiple of the motion that the force causes in the free device at 16 Hz
/// has another cause. An underdamped hand doubles the motion.
constexpr double kResonance = 2;
/// Length below which a heading has no direction: the tool turned back.
constexpr double kLeastHeading = 0.5;

double part_of(double dt_s, double time_s) noexcept { return 1 - std::exp(-dt_s / time_s); }

/// Returns a direction across the arm. A push in this direction moves the least mass.
Vec3 across(Vec3 arm_mm) noexcept {
  const Vec3 other = std::abs(arm_mm.x) < std::abs(arm_mm.y) ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  const Vec3 normal = cross(arm_mm, other);
  const double size = length(normal);
  return size > 0 ? normal * (1 / size) : other;
}

}  // namespace

ContactLimits cut_limits(ContactLimits contact) noexcept {
  contact.max_stiffness *= kCutStiffnessShare;
  contact.max_damping = std::min(contact.max_damping, kCutDamping);
  return contact;
}

ContactGains gains_across(const ContactLimits& limits, Vec3 arm_mm) noexcept {
  const double delay_s = limits.force_delay_s + kDelayTickS / 2;  // at most a whole period
  double damping = limits.max_damping;
  const double mass = moved_mass(limits, arm_mm, across(arm_mm));
  if (mass > 0) damping = std::min(damping, kMassShare * mass / (delay_s + kFilterS) / kMmPerM);
  return {.stiffness = std::min(limits.max_stiffness, kSpringShare * damping / delay_s),
          .damping = damping};
}

Vec3 Trembling::Fast::take(Vec3 value, double part) noexcept {
  mean = mean + (value - mean) * part;
  const Vec3 rest = value - mean;
  mean_of_rest = mean_of_rest + (rest - mean_of_rest) * part;
  return rest - mean_of_rest;
}

void Trembling::take(Vec3 force_n, Vec3 moved_mm, double dt_s) noexcept {
  if (!(dt_s > 0)) return;
  const double fast = part_of(dt_s, kFastS), mean = part_of(dt_s, kMeanS);
  const Vec3 force = force_.take(force_n, fast);
  const Vec3 velocity = velocity_.take(moved_mm * (1 / dt_s), fast);
  count_reversals(velocity, dt_s);
  power_ += (dot(force, velocity) - power_) * mean;
  force_square_ += (dot(force, force) - force_square_) * mean;
  speed_square_ += (dot(velocity, velocity) - speed_square_) * mean;
  earlier_square_ += (speed_square_ - earlier_square_) * part_of(dt_s, kEarlierS);
}

void Trembling::count_reversals(Vec3 velocity, double dt_s) noexcept {
  since_s_ += dt_s;
  const double square = dot(velocity, velocity), peak_square = dot(peak_, peak_);
  if (since_s_ > kHalfPeriodS) {
    reversals_ = 0;
    since_s_ = 0;
    peak_ = velocity;
  } else if (dot(velocity, peak_) < 0 && square > kReversed * kReversed * peak_square) {
    ++reversals_;
    since_s_ = 0;
    peak_ = velocity;
  } else if (square > peak_square) {
    peak_ = velocity;
  }
}

double Trembling::driven() const noexcept {
  const double most = std::sqrt(force_square_ * (speed_square_ + kLeastSpeed * kLeastSpeed));
  return most > 0 ? power_ / most : 0;
}

bool Trembling::grows() const noexcept { return speed_square_ > kGrows * earlier_square_; }

double Trembling::compliance() const noexcept {
  return force_square_ > 0 ? kFastS * std::sqrt(speed_square_ / force_square_) : 0;
}

CutCoupling::CutCoupling(const ContactLimits& limits, double least_most_mm_per_n) noexcept
    : limits_(limits), least_most_(least_most_mm_per_n) {
  // The delay is the latency and half to one period.
  const double ticks = std::round(limits.force_delay_s / kDelayTickS - kPeriodShare);
  latency_ticks_ = static_cast<std::size_t>(std::clamp(ticks, 0.0, kKept - 1.0));
}

void CutCoupling::adapt(Vec3 moved_mm, Vec3 arm_mm, double dt_s) noexcept {
  trembling_.take(forces_[(newest_ + kKept - latency_ticks_) % kKept], moved_mm, dt_s);
  // Keep the compliance at rest in a cut: a stiffer tool would tremble again.
  const bool rests = held_ || length(moved_mm) <= kLeastSpeed * dt_s;
  if (!rests || !(length(slipped_n_) > 0)) compliance_ *= std::exp(-dt_s / kFallS);
  const double driven = (trembling_.driven() - kDriven) / (1 - kDriven);
  if (!(driven > 0) || !trembling_.grows() || !trembling_.swings()) return;
  // At a corner of the path, a weak force that is one answer late may drive by chance.
  const double mass = moved_mass(limits_, arm_mm, across(arm_mm));
  const double most = kResonance * kFastS * kFastS * kMmPerM / mass;  // mm/N
  if (mass > 0 && trembling_.compliance() > most) return;
  compliance_ += (compliance_ + trembling_.compliance()) * driven * dt_s / kGrowS;
  const double stable = kStiffnesses / gains_across(limits_, arm_mm).stiffness;
  compliance_ = std::min(compliance_, std::max(stable, least_most_));
}

/// Returns the rotation of the heading over this displacement.
Vec3 CutCoupling::turn(Vec3 moved_mm, double memory_mm) noexcept {
  const Vec3 before = heading_;
  const double over_mm = kHeadingShare * memory_mm + length(moved_mm);
  if (!(length(moved_mm) > 0)) return {};
  heading_ = (heading_ * (kHeadingShare * memory_mm) + moved_mm) * (1 / over_mm);
  if (length(before) < kLeastHeading || length(heading_) < kLeastHeading) return {};
  const Vec3 normal = cross(before, heading_);
  const double sine = length(normal);
  return sine > 0 ? normal * (std::atan2(sine, dot(before, heading_)) / sine) : Vec3{};
}

void CutCoupling::remember(Vec3 force_n) noexcept {
  newest_ = (newest_ + 1) % kKept;
  forces_[newest_] = force_n;
}

/// Returns the displacement of the end of the arm since the last tick.
Vec3 CutCoupling::follow(Vec3 arm_mm, const PastGrip& now) noexcept {
  const Vec3 moved = has_grip_ ? between(grip_, now.grip).at(arm_mm) : Vec3{};
  grip_ = now.grip;
  has_grip_ = true;
  return moved;
}

/// Returns the component of the force along itself after it pushed the tool back by `back_mm`. It
/// follows the computed force, but falls by no more than the elastic tool is unloaded, and by no
/// less than over the path of a heading. A late computed force then cannot drive the tool.
double CutCoupling::held_n(double target_n, double back_mm) const noexcept {
  const double newtons = length(rendered_.force_n);
  const double least = newtons - back_mm / compliance_;
  const double most = newtons - back_mm / std::max(compliance_, kHeadingMm / newtons);
  return std::clamp(target_n, least, most);
}

/// Moves the rendered wrench like that of an elastic tool held at its position in the material.
/// Returns false and changes nothing if the tool slips: the computed force is greater, the force
/// would exceed that of the last slip, or the tool is slack.
bool CutCoupling::hold(const Wrench& target, Vec3 moved_mm) noexcept {
  const double newtons = length(rendered_.force_n);
  if (!(newtons > 0) || !(compliance_ > 0)) return false;
  const Vec3 along = rendered_.force_n * (1 / newtons);
  const double back_mm = dot(along, moved_mm);
  const double target_n = dot(along, target.force_n);
  Vec3 force = rendered_.force_n - moved_mm * (1 / compliance_);
  if (back_mm > 0) {
    const double kept_n = held_n(target_n, back_mm);
    if (!(kept_n > 0)) return false;
    force = force + along * (kept_n - dot(along, force));
  } else if (target_n > newtons) {
    return false;
  }
  const double size_n = length(force);
  if (size_n > length(slipped_n_) || !(dot(force, slipped_n_) > 0)) return false;
  rendered_ = {force, rendered_.torque_nmm * (size_n / newtons)};
  return true;
}

/// Returns the damping of a held tool, N s/mm: the damping that the device renders stably together
/// with its stiffest spring. A stiffer coupling has proportionally less, so that damping begins
/// without a step.
double CutCoupling::damping_at_rest(Vec3 arm_mm) const noexcept {
  const ContactGains stable = gains_across(limits_, arm_mm);
  return stable.damping * std::min(1.0, compliance_ * stable.stiffness);
}

Wrench CutCoupling::at(const Wrench& target, Vec3 arm_mm, const PastGrip& now,
                       double dt_s) noexcept {
  const Vec3 moved = follow(arm_mm, now);
  adapt(moved, arm_mm, dt_s);

  const double newtons = std::max(length(rendered_.force_n), length(target.force_n));
  const double memory_mm = newtons * compliance_;
  const Vec3 turned = turn(moved, memory_mm);
  const double part = memory_mm > 0 ? 1 - std::exp(-length(moved) / memory_mm) : 1;
  const Wrench about_middle{target.force_n, target.torque_nmm - cross(arm_mm, target.force_n)};
  const Wrench before{rotated(rendered_.force_n, turned), rotated(rendered_.torque_nmm, turned)};
  held_ = hold(about_middle, moved);
  if (!held_) {
    rendered_ = before + (about_middle - before) * part;
    slipped_n_ = rendered_.force_n;
  }
  const double damping = held_ ? damping_at_rest(arm_mm) : 0;
  const Vec3 force = rendered_.force_n - now.velocity.at(arm_mm) * damping;
  remember(force);
  if (!held_ && part == 1) return target;
  Vec3 torque = rendered_.torque_nmm + cross(arm_mm, force);
  torque = torque - now.grip.axis * dot(torque, now.grip.axis);
  return {force, torque};
}

void CutCoupling::release(Vec3 arm_mm, const PastGrip& now, double dt_s) noexcept {
  held_ = false;
  slipped_n_ = {};
  adapt(follow(arm_mm, now), arm_mm, dt_s);
  rendered_ = {};
  remember({});
}

}  // namespace kerf::agent
