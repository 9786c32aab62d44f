// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/servo/local_model.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "haptic_agent/device/units.h"

namespace kerf::agent {
namespace {

/// Below this speed an answer gives no damping coefficient, mm/s.
constexpr double kMinSpeed = 0.2;
/// Time constant of the weights in the trend: kTrendS plus kTrendOfLag of the delay.
constexpr double kTrendS = 0.005;
constexpr double kTrendOfLag = 0.5;
/// Cut forces from answers up to this age are rendered unfitted, s: a fit over the path would
/// smooth abrupt changes, as at the end of a plunge or with each chip of a milling cutter. A tooth
/// ripple in an older answer does not apply to the present pose.
constexpr double kFreshLagS = 0.002;
/// The cutting force fades between these two cosines of the angle between the heading and that of
/// the answer: a reversing tool cuts nothing.
constexpr double kFullCos = 0.5;
constexpr double kNoneCos = -0.5;

/// Returns the rotation vector from one direction to another.
Vec3 turn_between(Vec3 from, Vec3 to) noexcept {
  const Vec3 normal = cross(from, to);
  const double sine = length(normal);
  return sine > 0 ? normal * (std::atan2(sine, dot(from, to)) / sine) : Vec3{};
}

}  // namespace

Vec3 LocalModel::heading(Vec3 before, Vec3 moved_mm) noexcept {
  return (before * kHeadingMm + moved_mm) * (1 / (kHeadingMm + length(moved_mm)));
}

void LocalModel::take(const ServerWrench& answer, const PastGrip& then,
                      const PastGrip& now) noexcept {
  obstacles_.take(answer, then.grip, now.grip, now.velocity);
  ServerWrench rest = answer;
  rest.wrench = answer.wrench - obstacles_.in_answer();
  take_stock(rest, then, now);
}

void LocalModel::take_replica(const ServerWrench& answer, const PastGrip& then,
                              const PastGrip& now) noexcept {
  take_stock(answer, then, now);
}

/// Sets stock contact and cut from the server or the replica, whichever answered the newer pose.
void LocalModel::take_stock(const ServerWrench& answer, const PastGrip& then,
                            const PastGrip& now) noexcept {
  if (answer.pose_us < answered_us_) return;
  answered_us_ = answer.pose_us;
  stock_.take(answer, then.grip, now.grip, now.velocity);
  take_cut(answer, then);
  lag_s_ = static_cast<double>(now.time_us - then.time_us) * kSPerUs;
}

void LocalModel::take_cut(const ServerWrench& answer, const PastGrip& then) noexcept {
  if (!(answer.engaged_area_mm2 > 0) || !(length(then.heading) > 0)) {
    trend_.reset();
    return;
  }
  cut_ = answer.wrench - stock_.in_answer();
  arm_mm_ = answer.cut_centre_mm - then.grip.pivot_mm;
  double strength = length(cut_.force_n);
  if (settings_.law == CutLaw::kRemovalRate) {
    const double speed = length(then.velocity.at(arm_mm_));
    if (speed < kMinSpeed) return;
    strength /= speed;
  }
  const double passed_s = then.time_us > then_.time_us
                              ? static_cast<double>(then.time_us - then_.time_us) * kSPerUs
                              : 0;
  then_ = then;
  const double kept =
      lag_s_ <= kFreshLagS ? 0 : std::exp(-passed_s / (kTrendS + kTrendOfLag * lag_s_));
  trend_.take(then.path_mm, strength, kept);
}

Vec3 LocalModel::arm(const PastGrip& now) const noexcept {
  return rotated(arm_mm_, between(then_.grip, now.grip).angular);
}

Wrench LocalModel::cut(const PastGrip& now, Vec3 arm, double& rendered) const noexcept {
  rendered = 1;
  const double answered_n = length(cut_.force_n);
  if (trend_.empty() || !(answered_n > 0)) return {};
  const double length_now = length(now.heading), length_then = length(then_.heading);
  if (!(length_now > 0)) return {};
  const Vec3 turn = turn_between(then_.heading, now.heading);
  const double cosine = dot(then_.heading, now.heading) / (length_now * length_then);
  const double kept = std::clamp((cosine - kNoneCos) / (kFullCos - kNoneCos), 0.0, 1.0);

  double newtons = trend_.at(now.path_mm);
  if (settings_.law == CutLaw::kRemovalRate) {
    ContactLimits limits = settings_.contact;
    limits.max_damping = settings_.max_damping;
    const double most = gains_across(limits, arm).damping;
    if (newtons > most) rendered = most / newtons;
    newtons *= length(now.velocity.at(arm));
  }
  newtons *= kept * std::min(1.0, length_now / length_then);
  const double scale = newtons / answered_n;
  const Vec3 force = rotated(cut_.force_n, turn) * scale;
  // Rotate the rest of the torque too, which does not come from the cut's center.
  const Vec3 rest = rotated(cut_.torque_nmm - cross(arm_mm_, cut_.force_n), turn) * scale;
  Vec3 torque = cross(arm, force) + rest;
  torque = torque - now.grip.axis * dot(torque, now.grip.axis);
  return {force, torque};
}

/// A first-order low pass at the greatest frequency that the device renders. It keeps nothing of an
/// earlier cut.
Wrench LocalModel::within_band(const Wrench& cutting, double dt_s) noexcept {
  if (settings_.law != CutLaw::kMechanistic || !(settings_.max_vibration_hz > 0)) return cutting;
  if (!(dot(cutting.force_n, cutting.force_n) > 0)) return in_band_ = {};
  const double passed = 2 * std::numbers::pi * settings_.max_vibration_hz * dt_s;
  in_band_ = in_band_ + (cutting - in_band_) * (1 - std::exp(-passed));
  return in_band_;
}

Wrench LocalModel::at(const PastGrip& now, const PastGrip& measured, bool cutting,
                      double dt_s) noexcept {
  const Wrench touched = stock_.at(measured.grip, measured.velocity, dt_s) +
                         obstacles_.at(measured.grip, measured.velocity, dt_s);
  computed_ = stock_.computed() + obstacles_.computed();
  compliance_ = 0;
  const Vec3 arm = this->arm(now);
  if (!cutting) {
    in_band_ = {};
    coupling_.release(arm, now, dt_s);
    return touched;
  }
  double rendered = 1;
  const Wrench cutting_wrench = cut(now, arm, rendered);
  computed_ = computed_ + cutting_wrench;
  // Under the removal-rate law the damping is limited instead.
  if (settings_.law == CutLaw::kRemovalRate) return touched + cutting_wrench * rendered;
  const Wrench coupled = coupling_.at(within_band(cutting_wrench, dt_s), arm, now, dt_s);
  if (!trend_.empty()) compliance_ = coupling_.compliance_mm_per_n();
  return touched + coupled;
}

}  // namespace kerf::agent
