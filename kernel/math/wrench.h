// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernel/math/vec3.h"

namespace kerf {

/// Force (N) at a pivot and torque (N·mm) about it.
struct Wrench {
  Vec3 force_n{};
  Vec3 torque_nmm{};
  friend constexpr bool operator==(const Wrench&, const Wrench&) = default;
};

constexpr Wrench operator+(const Wrench& a, const Wrench& b) noexcept {
  return {a.force_n + b.force_n, a.torque_nmm + b.torque_nmm};
}
constexpr Wrench operator-(const Wrench& a, const Wrench& b) noexcept {
  return {a.force_n - b.force_n, a.torque_nmm - b.torque_nmm};
}
constexpr Wrench operator*(const Wrench& a, double s) noexcept {
  return {a.force_n * s, a.torque_nmm * s};
}

/// Greatest force and torque that a device outputs.
struct WrenchMaximum {
  double force_n = 0;
  double torque_nmm = 0;
};

/// Returns the factor, 0 to 1, by which a device scales a wrench down to its maximum. One factor
/// for force and torque keeps the screw axis and their ratio; separate factors would give the
/// wrench of a different cut.
inline double share_within(const WrenchMaximum& most, const Wrench& wrench) noexcept {
  const double force = length(wrench.force_n);
  const double torque = length(wrench.torque_nmm);
  double share = 1;
  if (force > most.force_n) share = most.force_n / force;
  if (torque > most.torque_nmm && most.torque_nmm / torque < share)
    share = most.torque_nmm / torque;
  return share;
}

/// Tests the squared lengths, so a wrench whose squares overflow is not finite either.
inline bool is_finite(const Wrench& wrench) noexcept {
  return __builtin_isfinite(dot(wrench.force_n, wrench.force_n)) &&
         __builtin_isfinite(dot(wrench.torque_nmm, wrench.torque_nmm));
}

/// Displacement (mm, rad) or velocity (mm/s, rad/s) of a rigid body: linear for its reference
/// point, angular as a rotation vector.
struct Twist {
  Vec3 linear{};
  Vec3 angular{};

  /// Displacement or velocity of the body's point at `arm_mm` from the reference point.
  constexpr Vec3 at(Vec3 arm_mm) const noexcept { return linear + cross(angular, arm_mm); }
};

constexpr Twist operator+(const Twist& a, const Twist& b) noexcept {
  return {a.linear + b.linear, a.angular + b.angular};
}
constexpr Twist operator*(const Twist& a, double s) noexcept {
  return {a.linear * s, a.angular * s};
}

/// Returns the work (mJ) that the wrench does over a displacement, or its power (mW) at a velocity.
/// Positive if the wrench drives the body, negative if it holds it back.
constexpr double work(const Wrench& wrench, const Twist& twist) noexcept {
  return dot(wrench.force_n, twist.linear) + dot(wrench.torque_nmm, twist.angular);
}

}  // namespace kerf
