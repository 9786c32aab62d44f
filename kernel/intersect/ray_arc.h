// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>

#include "kernel/math/lanes.h"
#include "kernel/math/span.h"
#include "kernel/math/tolerance.h"
#include "kernel/math/vec3.h"
#include "kernel/piece/arc.h"

namespace kerf {

/// Intersection of eight dexel rays with a solid arc piece at one pose, in one interval: Newton's
/// method along the ray from both ends of a range that encloses the piece. The side's distance F is
/// convex along a ray, so the steps approach each root from outside and never pass it.
struct RayArc {
  Vec3 center, axis;  ///< the arc's center projected on the tool's axis; the unit axis
  double low, high;   ///< heights of the discs above it
  double center_r, radius, reach2, inverse_uz;

  RayArc(const ArcPiece& p, Vec3 tip_mm, Vec3 unit_axis)
      : center(tip_mm + unit_axis * p.center_z_mm),
        axis(unit_axis),
        low(p.z0_mm - p.center_z_mm),
        high(p.z1_mm - p.center_z_mm),
        center_r(p.center_r_mm),
        radius(p.radius_mm),
        reach2(square(extent(p).radius_mm) + square(std::max(std::abs(low), std::abs(high)))),
        inverse_uz(1 /
                   (std::abs(unit_axis.z) > kAxisAlongRayMin ? unit_axis.z : kAxisAlongRayMin)) {}

  KERF_INLINE void extend(LaneSpan& span, Lanes x, Lanes y) const {
    const Lanes px = x - center.x, py = y - center.y;
    const Lanes p2 = px * px + py * py, along = px * axis.x + py * axis.y;
    const Lanes half2 = reach2 - p2;
    const Lanes half = square_root(greater(half2, Lanes(0)));
    const Lanes to_low = (low - along) * inverse_uz, to_high = (high - along) * inverse_uz;
    const Lanes first = greater(lesser(to_low, to_high), -half);
    const Lanes last = lesser(greater(to_low, to_high), half);
    LaneMask hit = (half2 >= 0.0) & (first <= last);
    if (!any(hit)) return;
    Lanes in = first, out = last;
    hit = approach<1>(p2, along, last, hit, in);
    if (!any(hit)) return;
    hit = approach<-1>(p2, along, first, hit, out);
    span.lo = select(hit & (center.z + in < span.lo), center.z + in, span.lo);
    span.hi = select(hit & (center.z + out > span.hi), center.z + out, span.hi);
  }

 private:
  static constexpr int kSteps = 60;  ///< at a grazed arc each step halves the distance
  static constexpr double square(double v) { return v * v; }

  /// Moves t by Newton's steps upwards (kSign 1) or downwards (−1) to the side, in the lanes
  /// `asked`, at most to `end`. Returns the lanes where it is reached.
  template <int kSign>
  KERF_INLINE LaneMask approach(Lanes p2, Lanes along, Lanes end, LaneMask asked, Lanes& t) const {
    LaneMask moving = asked, met = asked;
    for (int i = 0; i < kSteps; ++i) {
      const Lanes l = along + axis.z * t;
      const Lanes rho = square_root(greater(p2 + t * t - l * l, Lanes(0)));
      const CircleDistance<Lanes> d = circle_distance(center_r, radius, rho, l);
      moving &= d.mm > kArcFoundMm;
      if (!any(moving)) break;
      const Lanes share = select(rho > 0.0, d.across / rho, Lanes(0));
      const Lanes slope = share * (t - l * axis.z) + l * axis.z;  // of F, times the length
      const LaneMask closes = kSign > 0 ? slope < 0.0 : slope > 0.0;
      const Lanes next = t - d.mm * d.length / slope;
      const LaneMask within = kSign > 0 ? next <= end : next >= end;
      met &= ~(moving & ~(closes & within));
      moving &= closes & within;
      t = select(moving, next, t);
    }
    return met;
  }
};

}  // namespace kerf
