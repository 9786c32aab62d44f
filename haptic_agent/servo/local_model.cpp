// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/servo/local_model.h"

#include <algorithm>
#include <cmath>

namespace kerf::agent {
namespace {

/// mm of way over which a new direction is taken on. A device that shows k N/mm stably can show a
/// force of F turning back over F/k: less would be a spring that it cannot hold.
constexpr double kHeadingMm = 0.5;
/// Slower than this nothing can be said of the damping that an answer stands for, mm/s.
constexpr double kLeastSpeed = 2;
/// An answer counts e times less after this time and half the delay.
constexpr double kTrendS = 0.005;
constexpr double kTrendOfLag = 0.5;
/// The cut of a tool that has turned by more than the first keeps less and less of its force, and
/// by more than the second none: who turns back cuts nothing. As cosines.
constexpr double kFullCos = 0.5;
constexpr double kNoneCos = -0.5;

/// The rotation vector that takes one direction to another.
Vec3 turn_between(Vec3 from, Vec3 to) noexcept {
  const Vec3 normal = cross(from, to);
  const double sine = length(normal);
  return sine > 0 ? normal * (std::atan2(sine, dot(from, to)) / sine) : Vec3{};
}

}  // namespace

Vec3 LocalModel::heading(Vec3 before, Vec3 moved_mm) noexcept {
  return (before * kHeadingMm + moved_mm) * (1 / (kHeadingMm + length(moved_mm)));
}

void LocalModel::take(const ServerWrench& answer, const PastHold& then,
                      const PastHold& now) noexcept {
  obstacles_.take(answer, then.hold, now.hold);
  ServerWrench rest = answer;
  rest.wrench = answer.wrench - obstacles_.in_answer();
  take_stock(rest, then, now);
}

void LocalModel::take_near(const ServerWrench& answer, const PastHold& then,
                           const PastHold& now) noexcept {
  take_stock(answer, then, now);
}

/// Takes contact with the stock and the cut from whoever has answered the newest pose.
void LocalModel::take_stock(const ServerWrench& answer, const PastHold& then,
                            const PastHold& now) noexcept {
  if (answer.pose_us < answered_us_) return;
  answered_us_ = answer.pose_us;
  stock_.take(answer, then.hold, now.hold);
  take_cut(answer, then);
  constexpr double kSPerUs = 1e-6;
  lag_s_ = static_cast<double>(now.time_us - then.time_us) * kSPerUs;
}

void LocalModel::take_cut(const ServerWrench& answer, const PastHold& then) noexcept {
  if (!(answer.engaged_area_mm2 > 0) || !(length(then.heading) > 0)) {
    trend_.reset();
    return;
  }
  cut_ = answer.wrench - stock_.in_answer();
  arm_mm_ = answer.cut_centre_mm - then.hold.pivot_mm;
  double strength = length(cut_.force_n);
  if (settings_.law == CutLaw::kRemovalRate) {
    const double speed = length(then.velocity.at(arm_mm_));
    if (speed < kLeastSpeed) return;
    strength /= speed;
  }
  constexpr double kSPerUs = 1e-6;
  const double passed_s = then.time_us > then_.time_us
                              ? static_cast<double>(then.time_us - then_.time_us) * kSPerUs
                              : 0;
  then_ = then;
  trend_.take(then.way_mm, strength, std::exp(-passed_s / (kTrendS + kTrendOfLag * lag_s_)));
}

Wrench LocalModel::cut(const PastHold& now) const noexcept {
  const double answered_n = length(cut_.force_n);
  if (trend_.empty() || !(answered_n > 0)) return {};
  const double going = length(now.heading), went = length(then_.heading);
  if (!(going > 0)) return {};
  const Vec3 turn = turn_between(then_.heading, now.heading);
  const double cosine = dot(then_.heading, now.heading) / (going * went);
  const double kept = std::clamp((cosine - kNoneCos) / (kFullCos - kNoneCos), 0.0, 1.0);
  const Vec3 arm = rotated(arm_mm_, between(then_.hold, now.hold).angular);

  double newtons = trend_.at(now.way_mm);
  if (settings_.law == CutLaw::kRemovalRate) {
    newtons = std::min(newtons, settings_.damping_most) * length(now.velocity.at(arm));
  }
  newtons *= kept * std::min(1.0, going / went);
  const double scale = newtons / answered_n;
  const Vec3 force = rotated(cut_.force_n, turn) * scale;
  // What the centre of the cut does not explain of the answered torque turns along.
  const Vec3 rest = rotated(cut_.torque_nmm - cross(arm_mm_, cut_.force_n), turn) * scale;
  Vec3 torque = cross(arm, force) + rest;
  torque = torque - now.hold.axis * dot(torque, now.hold.axis);
  return {force, torque};
}

Wrench LocalModel::at(const PastHold& now, bool cutting, double dt_s) noexcept {
  const Wrench touched = stock_.at(now.hold, dt_s) + obstacles_.at(now.hold, dt_s);
  return cutting ? touched + cut(now) : touched;
}

}  // namespace kerf::agent
