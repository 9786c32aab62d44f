// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "kernel/math/vec3.h"
#include "server/formats/machine_kinematics.h"

namespace kerf {

/// Coordinates of the axes X Y Z in mm and A B C in degrees, in this order.
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

/// Rotates (x, y) about Z. Rotation by 0 degrees leaves them bit-identical.
inline void turn_xy(double& x, double& y, double degrees) {
  if (degrees == 0) return;
  const double angle = degrees * std::numbers::pi / 180;
  const double c = std::cos(angle);
  const double s = std::sin(angle);
  const double turned = x * c - y * s;
  y = x * s + y * c;
  x = turned;
}

/// Work offsets between programmed and machine coordinates, combined as in LinuxCNC:
///     absolute = rotate_z(programmed * scale + shift, rotation_deg) + origin
///     machine  = absolute + tool offset
struct GcodeFrame {
  GcodeAxes origin{};       ///< origin of the active coordinate system (G54 to G59.3)
  GcodeAxes shift{};        ///< offset of G92 or G52
  double rotation_deg = 0;  ///< rotation of the coordinate system about Z (G10 L2 R)
  /// Factors of X, Y and Z, negative for a mirrored axis (G51, G51.1); not 0.
  std::array<double, 3> scale{1, 1, 1};

  /// Converts programmed to absolute coordinates: work offsets removed, tool offset not included.
  GcodeAxes absolute(const GcodeAxes& programmed) const {
    GcodeAxes axes = programmed;
    for (std::size_t i = 0; i < scale.size(); ++i) axes[i] *= scale[i];
    axes = axes + shift;
    turn_xy(axes[0], axes[1], rotation_deg);
    return axes + origin;
  }
  /// Inverse of absolute().
  GcodeAxes programmed(const GcodeAxes& absolute_axes) const {
    GcodeAxes axes = absolute_axes - origin;
    turn_xy(axes[0], axes[1], -rotation_deg);
    axes = axes - shift;
    for (std::size_t i = 0; i < scale.size(); ++i) axes[i] /= scale[i];
    return axes;
  }
};

}  // namespace kerf
