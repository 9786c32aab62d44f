// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>

#include "kernel/math/wrench.h"

namespace kerf::agent {

/// Pose of the tool as the device holds it: the pivot, at which force and torque act, and the
/// tool's axis (unit).
struct Grip {
  Vec3 pivot_mm{};
  Vec3 axis{0, 0, 1};
};

/// Returns the shortest motion from one grip to another. The axis turns on the great circle; there
/// is no rotation about the axis itself (five degrees of freedom).
inline Twist between(const Grip& from, const Grip& to) noexcept {
  const Vec3 normal = cross(from.axis, to.axis);
  const double sine = length(normal);
  const double angle = std::atan2(sine, dot(from.axis, to.axis));
  return {to.pivot_mm - from.pivot_mm, sine > 0 ? normal * (angle / sine) : Vec3{}};
}

/// Rotates `v` by a rotation vector (Rodrigues).
inline Vec3 rotated(Vec3 v, Vec3 turn_rad) noexcept {
  const double angle = length(turn_rad);
  if (!(angle > 0)) return v;
  const Vec3 k = turn_rad * (1 / angle);
  return v * std::cos(angle) + cross(k, v) * std::sin(angle) +
         k * (dot(k, v) * (1 - std::cos(angle)));
}

}  // namespace kerf::agent
