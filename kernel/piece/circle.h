// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernel/math/lanes.h"

namespace kerf {

// Shared by ball and arc: a circle in the half-plane (ρ, h), where ρ is the distance from
// the tool's axis and h the height. Real is double or Lanes.

/// Returns half the length of the chord at the distance `off` from the center, or 0 beyond the
/// circle.
template <class Real>
KERF_INLINE Real half_chord(double radius, Real off) {
  return square_root(greater(radius * radius - off * off, splat_like(off, 0)));
}

/// Returns the derivative of half_chord by `off`; infinite at the ends of the diameter.
template <class Real>
KERF_INLINE Real half_chord_slope(double radius, Real off) {
  return -off / half_chord(radius, off);
}

/// Signed distance of a point from the outer side of a circle, negative inside. Its gradient in the
/// half-plane is (across, along) / length, undefined where the length is 0.
template <class Real>
struct CircleDistance {
  Real mm;
  Real across, along, length;
};

/// Returns the signed distance of a point from the side of a ball or an arc. `center_r` is the
/// distance of the circle's center from the axis, `rho` that of the point, and `along` the point's
/// height above the center. A point nearer to the axis than the center counts as at the center's
/// distance, because the body is the convex hull of the arc and the axis, not a torus.
template <class Real>
KERF_INLINE CircleDistance<Real> circle_distance(double center_r, double radius, Real rho,
                                                 Real along) {
  const Real across = greater(rho - center_r, splat_like(rho, 0));
  const Real length = square_root(across * across + along * along);
  return {length - radius, across, along, length};
}

}  // namespace kerf
