// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>

#include "haptic_agent/device/haptic_device.h"

namespace kerf::agent {

/// Where a hand holds the tool: the pivot, at which force and torque act, and the tool's axis.
struct Hold {
  Vec3 pivot_mm{};
  Vec3 axis{0, 0, 1};
};

/// How a hold moves: the pivot (mm, or mm/s) and the axis, as a rotation (rad, or rad/s). Nothing
/// turns about the axis itself: five degrees of freedom.
struct Twist {
  Vec3 move{};
  Vec3 turn{};
};

constexpr Twist operator+(const Twist& a, const Twist& b) noexcept {
  return {a.move + b.move, a.turn + b.turn};
}
constexpr Twist operator*(const Twist& a, double s) noexcept { return {a.move * s, a.turn * s}; }

constexpr Wrench operator+(const Wrench& a, const Wrench& b) noexcept {
  return {a.force_n + b.force_n, a.torque_nmm + b.torque_nmm};
}
constexpr Wrench operator-(const Wrench& a, const Wrench& b) noexcept {
  return {a.force_n - b.force_n, a.torque_nmm - b.torque_nmm};
}
constexpr Wrench operator*(const Wrench& a, double s) noexcept {
  return {a.force_n * s, a.torque_nmm * s};
}

/// The shortest motion from one hold to another; the axis turns on the great circle.
inline Twist between(const Hold& from, const Hold& to) noexcept {
  const Vec3 normal = cross(from.axis, to.axis);
  const double sine = length(normal);
  const double angle = std::atan2(sine, dot(from.axis, to.axis));
  return {to.pivot_mm - from.pivot_mm, sine > 0 ? normal * (angle / sine) : Vec3{}};
}

/// What a wrench does to a hand that moves so: mJ for a motion, mW for a velocity. Above zero: the
/// hand is driven; below: it is held back.
constexpr double work(const Wrench& wrench, const Twist& twist) noexcept {
  return dot(wrench.force_n, twist.move) + dot(wrench.torque_nmm, twist.turn);
}

/// Velocity of a point that is carried along, given from the pivot.
constexpr Vec3 velocity_at(const Twist& twist, Vec3 arm_mm) noexcept {
  return twist.move + cross(twist.turn, arm_mm);
}

inline bool is_finite(const Wrench& wrench) noexcept {
  return std::isfinite(dot(wrench.force_n, wrench.force_n)) &&
         std::isfinite(dot(wrench.torque_nmm, wrench.torque_nmm));
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
