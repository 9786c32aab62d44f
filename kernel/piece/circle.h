// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernel/math/lanes.h"

namespace kerf {

// What the ball and the arc share: a circle in the half-plane (ρ, h), where ρ is the distance from
// the tool's axis and h the height. Real is double or Lanes.

/// Half the length of the chord at the distance `off` from the center; 0 beyond the circle.
template <class Real>
KERF_INLINE Real half_chord(double radius, Real off) {
  return square_root(greater(radius * radius - off * off, splat_like(off, 0)));
}

/// Derivative of half_chord by `off`; infinite at the ends of the diameter.
template <class Real>
KERF_INLINE Real half_chord_slope(double radius, Real off) {
  return -off / half_chord(radius, off);
}

/// Distance of a point from the outer side of a circle, negative inside. It grows in the direction
/// (across, along) / length of the half-plane; at the center that has no length.
template <class Real>
struct CircleDistance {
  Real mm;
  Real across, along, length;
};

/// `rho` is the point's distance from the axis, `along` its height above the circle's center. The
/// circle's center is `center_r` from the axis. A point on the axis' side of the center counts as
/// at the height of the arc's pole: the body is the hull of the arc, not a torus.
template <class Real>
KERF_INLINE CircleDistance<Real> circle_distance(double center_r, double radius, Real rho,
                                                 Real along) {
  const Real across = greater(rho - center_r, splat_like(rho, 0));
  const Real length = square_root(across * across + along * along);
  return {length - radius, across, along, length};
}

}  // namespace kerf
