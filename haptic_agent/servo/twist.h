// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>

#include "kernel/math/wrench.h"

namespace kerf::agent {

/// Where a hand holds the tool: the pivot, at which force and torque act, and the tool's axis.
struct Hold {
  Vec3 pivot_mm{};
  Vec3 axis{0, 0, 1};
};

/// The shortest motion of the pivot and the axis from one hold to another; the axis turns on the
/// great circle. Nothing turns about the axis itself: five degrees of freedom.
inline Twist between(const Hold& from, const Hold& to) noexcept {
  const Vec3 normal = cross(from.axis, to.axis);
  const double sine = length(normal);
  const double angle = std::atan2(sine, dot(from.axis, to.axis));
  return {to.pivot_mm - from.pivot_mm, sine > 0 ? normal * (angle / sine) : Vec3{}};
}

/// Rotates `v` with a rotation vector (Rodrigues).
inline Vec3 rotated(Vec3 v, Vec3 turn_rad) noexcept {
  const double angle = length(turn_rad);
  if (!(angle > 0)) return v;
  const Vec3 k = turn_rad * (1 / angle);
  return v * std::cos(angle) + cross(k, v) * std::sin(angle) +
         k * (dot(k, v) * (1 - std::cos(angle)));
}

}  // namespace kerf::agent
