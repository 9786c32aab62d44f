// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernel/math/vec3.h"

namespace kerf {

struct SinCos {
  double sin, cos;
};
/// Returns sine and cosine for |angle| <= pi, with errors below 4e-16. Uses + − × ÷ only: libm's
/// results differ between CPUs, and equal commands must give equal bytes.
SinCos sin_cos(double angle_rad);

/// Returns the angle between two unit vectors, in [0, pi]. Accurate for tiny angles too. Uses
/// + − × ÷ √ only.
double angle_between(Vec3 a, Vec3 b);

/// Returns the unit vector at `share` (0..1) of the great circle from a to b, uniform in angle.
/// `angle_rad` is angle_between(a, b), below pi. A share of 0 or 1 gives exactly a or b.
Vec3 great_circle(Vec3 a, Vec3 b, double angle_rad, double share);

/// The rotation that takes one unit vector to another on the shortest path.
class Turn {
 public:
  /// `from` and `to` must not be opposite.
  constexpr Turn(Vec3 from, Vec3 to) : sine_(cross(from, to)), rest_(1 / (1 + dot(from, to))) {}
  constexpr Vec3 operator()(Vec3 v) const {
    const Vec3 across = cross(sine_, v);
    return v + across + cross(sine_, across) * rest_;
  }

 private:
  Vec3 sine_;    ///< axis times the sine of the angle
  double rest_;  ///< 1 / (1 + cosine)
};

/// Returns a unit vector perpendicular to the unit vector a. Equal input gives equal bits.
Vec3 any_perpendicular(Vec3 a);

}  // namespace kerf
