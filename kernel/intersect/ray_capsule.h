// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "kernel/math/span.h"
#include "kernel/math/tolerance.h"
#include "kernel/math/vec3.h"

namespace kerf {

/// One end of the intervals that a capsule removes from eight rays, valid where `hit`.
struct LaneEnd {
  Lanes z;
  LaneMask hit;
};
KERF_INLINE void include(LaneEnd& end, LaneMask hit, Lanes z) { end = {z, hit}; }

/// Intersection of a dexel ray with the capsule that a sphere of radius r sweeps from one center to
/// another (paper section 2.4, intersection 1 and the sphere's translation). Seen along the motion,
/// the ray is at the distance `perp` from the path, where the sphere is a circle of radius ρ = √(r²
/// − perp²). The circle's lowest point on the ray belongs to the share s = (along − ρ dz/|d|)/h of
/// the motion, where h is the horizontal length of d. If s < 0 or s > 1, the sphere's position at
/// the start or the end decides. Each end is computed from its own center, so that the end of one
/// motion and the start of the next give the same bits.
struct RayCapsule {
  Vec3 from, to, d;
  double radius2, along_x, along_y, inverse_h, lean, inverse_length;
  double arrival;  ///< share from which on the end of the path is used

  RayCapsule(Vec3 from_mm, Vec3 to_mm, double radius_mm)
      : from(from_mm), to(to_mm), d(to_mm - from_mm), radius2(radius_mm * radius_mm) {
    const double h = std::sqrt(d.x * d.x + d.y * d.y);
    const double length_mm = length(d);
    along_x = h > 0 ? d.x / h : 1;
    along_y = h > 0 ? d.y / h : 0;
    // A plunge has no horizontal path: a huge 1 / h selects the lower and the upper position.
    inverse_h = h > 0 ? 1 / h : 1e300;
    lean = length_mm > 0 ? d.z / length_mm : 0;
    inverse_length = length_mm > 0 ? 1 / length_mm : 1e300;
    arrival = 1 - kArrivalMm * std::sqrt(radius_mm) * inverse_length;
  }

  /// Widens `span` by both ends of the swept interval.
  template <class AnySpan, class Real>
  KERF_INLINE void extend(AnySpan& span, Real x, Real y) const {
    include_end(span, x, y, splat_like(x, -1));
    include_end(span, x, y, splat_like(x, 1));
  }
  /// Returns the lower end of the swept interval.
  KERF_INLINE LaneEnd lower_end(Lanes x, Lanes y) const {
    LaneEnd end;
    include_end(end, x, y, Lanes(-1));
    return end;
  }
  /// Widens `span` by one end: the lower one for `side` −1, the upper one for +1.
  template <class AnySpan, class Real>
  KERF_INLINE void include_end(AnySpan& span, Real x, Real y, Real side) const {
    const Real px = x - from.x, py = y - from.y, qx = x - to.x, qy = y - to.y;
    const Real along = px * along_x + py * along_y;
    Real s = along * inverse_h;
    if (lean != 0) {
      const Real perp = px * along_y - py * along_x;
      const Real rho2 = radius2 - perp * perp;
      const Real rho = square_root(select(rho2 > 0.0, rho2, splat_like(x, 0)));
      s = (along + side * rho * lean) * inverse_h;
    }
    const auto starts = s <= 0.0, ends = s >= arrival;
    const Real ex = select(starts, px, select(ends, qx, px - s * d.x));
    const Real ey = select(starts, py, select(ends, qy, py - s * d.y));
    Real z = splat_like(x, from.z);
    if (d.z != 0) z = select(starts, z, select(ends, splat_like(x, to.z), from.z + s * d.z));
    const Real w2 = radius2 - ex * ex - ey * ey;
    include(span, w2 >= 0.0, z + side * square_root(w2));
  }
};

}  // namespace kerf
