// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernel/math/vec3.h"

namespace kerf {

/// Sine and cosine from + − × ÷ alone: libm's differ between CPUs, and equal commands must give
/// equal bytes. |angle| <= pi; error below 4e-16.
struct SinCos {
  double sin, cos;
};
SinCos sin_cos(double angle_rad);

/// Angle between two unit vectors, in [0, pi], from + − × ÷ √ alone; accurate for tiny angles too.
double angle_between(Vec3 a, Vec3 b);

/// The unit vector at `share` (0..1) of the great circle from a to b, uniformly in angle.
/// `angle_rad` is angle_between(a, b), below pi. share 0 and 1 give a and b themselves.
Vec3 great_circle(Vec3 a, Vec3 b, double angle_rad, double share);

/// Any unit vector perpendicular to the unit vector a, the same for equal bits.
Vec3 any_perpendicular(Vec3 a);

}  // namespace kerf
