// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "kernel/math/vec3.h"
#include "server/formats/machine_kinematics.h"

namespace kerf {

/// X Y Z in mm, A B C in degrees.
using GcodeAxes = std::array<double, 6>;

inline Vec3 linear(const GcodeAxes& axes) { return {axes[0], axes[1], axes[2]}; }
inline RotaryAngles rotary(const GcodeAxes& axes) { return {axes[3], axes[4], axes[5]}; }
inline void set_linear(GcodeAxes& axes, Vec3 xyz) {
  axes[0] = xyz.x;
  axes[1] = xyz.y;
  axes[2] = xyz.z;
}

inline GcodeAxes operator+(GcodeAxes a, const GcodeAxes& b) {
  for (std::size_t i = 0; i < a.size(); ++i) a[i] += b[i];
  return a;
}
inline GcodeAxes operator-(GcodeAxes a, const GcodeAxes& b) {
  for (std::size_t i = 0; i < a.size(); ++i) a[i] -= b[i];
  return a;
}

/// Turns X and Y about Z. By 0 degrees nothing changes, to the bit.
inline void turn_xy(double& x, double& y, double degrees) {
  if (degrees == 0) return;
  const double angle = degrees * std::numbers::pi / 180;
  const double c = std::cos(angle);
  const double s = std::sin(angle);
  const double turned = x * c - y * s;
  y = x * s + y * c;
  x = turned;
}

/// What stands between programmed coordinates and those of the machine, as LinuxCNC stacks it:
/// machine = turned by `rotation_deg` (programmed + shift) + origin, and the tool's offset on top.
struct GcodeFrame {
  GcodeAxes origin{};       ///< of the coordinate system in force (G54 to G59.3)
  GcodeAxes shift{};        ///< G92 or G52
  double rotation_deg = 0;  ///< of the coordinate system about Z (G10 L2 R)

  /// Coordinates without offsets; the tool's offset is not in them.
  GcodeAxes without(const GcodeAxes& programmed) const {
    GcodeAxes axes = programmed + shift;
    turn_xy(axes[0], axes[1], rotation_deg);
    return axes + origin;
  }
  /// The inverse of without().
  GcodeAxes programmed(const GcodeAxes& without_offsets) const {
    GcodeAxes axes = without_offsets - origin;
    turn_xy(axes[0], axes[1], -rotation_deg);
    return axes - shift;
  }
};

}  // namespace kerf
