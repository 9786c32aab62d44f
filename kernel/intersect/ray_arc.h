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

  /// The side's distance F at a height of the rays, and its derivative along them times the length
  /// of the normal.
  struct Off {
    CircleDistance<Lanes> d;
    Lanes slope, rho;
  };
  KERF_INLINE Off off_at(Lanes p2, Lanes along, Lanes t) const {
    const Lanes l = along + axis.z * t;
    const Lanes rho = square_root(greater(p2 + t * t - l * l, Lanes(0)));
    const CircleDistance<Lanes> d = circle_distance(center_r, radius, rho, l);
    const Lanes share = select(rho > 0.0, d.across / rho, Lanes(0));
    return {d, share * (t - l * axis.z) + l * axis.z, rho};
  }

  /// Returns the step to the root of the parabola that touches G = m² + l² − R² at t, with its
  /// first two derivatives: the exact root where the axis is upright or center_r is 0.
  template <int kSign>
  KERF_INLINE Lanes step_to_root(Lanes along, Lanes t, const Off& off) const {
    const Lanes growth = (t - (along + axis.z * t) * axis.z) / off.rho;
    const double lean2 = 1 - axis.z * axis.z, upright2 = axis.z * axis.z;
    const Lanes bend = lean2 - (lean2 - growth * growth) * (center_r / off.rho) + upright2;
    const Lanes off2 = off.d.mm * (off.d.mm + 2 * radius), slope = off.slope * double(kSign);
    return off2 / (square_root(slope * slope - bend * off2) - slope) * double(kSign);
  }

  /// Moves t upwards (kSign 1) or downwards (−1) to the side, in the lanes `asked`, at most to
  /// `end`: first to the root of a parabola, if F still falls there, then by Newton's steps, which
  /// stay outside. Returns the lanes where the side is reached.
  template <int kSign>
  KERF_INLINE LaneMask approach(Lanes p2, Lanes along, Lanes end, LaneMask asked, Lanes& t) const {
    Off off = off_at(p2, along, t);
    LaneMask moving = asked & (off.d.mm > kArcFoundMm), met = asked;
    if (!any(moving)) return met;
    const Lanes guess = t + step_to_root<kSign>(along, t, off);
    // Where F rises already the parabola's root lies behind t, and by convexity none lies ahead.
    LaneMask usable =
        moving & (kSign > 0 ? guess > t : guess < t) & (kSign > 0 ? guess <= end : guess >= end);
    if (any(usable)) {
      const Off there = off_at(p2, along, select(usable, guess, t));
      usable &= there.d.across > 0.0 & (kSign > 0 ? there.slope < 0.0 : there.slope > 0.0);
      t = select(usable, guess, t);
      off.d.mm = select(usable, there.d.mm, off.d.mm);
      off.d.length = select(usable, there.d.length, off.d.length);
      off.slope = select(usable, there.slope, off.slope);
      moving &= magnitude(off.d.mm) > kArcFoundMm;
    }
    for (int i = 0; i < kSteps && any(moving); ++i) {
      const LaneMask closes = kSign > 0 ? off.slope < 0.0 : off.slope > 0.0;
      const Lanes next = t - off.d.mm * off.d.length / off.slope;
      const LaneMask within = kSign > 0 ? next <= end : next >= end;
      met &= ~(moving & ~(closes & within));
      moving &= closes & within;
      t = select(moving, next, t);
      off = off_at(p2, along, t);
      moving &= off.d.mm > kArcFoundMm;
    }
    return met;
  }
};

}  // namespace kerf
