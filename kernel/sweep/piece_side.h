// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "kernel/math/tolerance.h"
#include "kernel/math/vec3_lanes.h"
#include "kernel/piece/arc.h"
#include "kernel/piece/frustum.h"

namespace kerf {

/// Intervals of eight dexel rays inside the side of a piece, continued beyond its two discs.
/// Heights t relative to the piece's anchor.
struct SideSpan {
  Lanes in, out;    ///< may be infinite
  LaneMask exists;  ///< false: the ray misses the side
  Lanes closest;    ///< of rays that miss: the height closest to the side
};

/// The side of a frustum (paper Eq. 2; a cylinder when the slope is 0), anchored at the center of
/// its lower disc. With p = (x, y, t) from the anchor and l = p·u the side is |p|² − l² = (r0 + k
/// l)², quadratic in t with A = u_x² + u_y² − k² u_z². A > 0: the inside is between the roots. A ≤
/// 0 (the ray is steeper than the generators): the inside is beyond one of them, on the nappe that
/// belongs to the tool.
struct ConeSide {
  double anchor, low, high;
  FrustumSide side;
  double by_chord2;  ///< estimated depth of a ray in the side, per squared length of its chord

  explicit ConeSide(const FrustumPiece& p)
      : anchor(p.z0_mm),
        low(0),
        high(p.z1_mm - p.z0_mm),
        side(p),
        by_chord2(0.125 / extent(p).radius_mm) {}

  /// `along` = x u_x + y u_y.
  KERF_INLINE SideSpan meet(Lanes x, Lanes y, const Vec3Lanes& u, Lanes along) const {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    const double r0 = side.r0_mm, slope = side.slope, k1 = 1 + slope * slope;
    const Lanes a = u.x * u.x + u.y * u.y - slope * slope * (u.z * u.z);
    const Lanes b = -(k1 * along + r0 * slope) * u.z;
    const Lanes c = x * x + y * y - k1 * along * along - 2 * r0 * slope * along - r0 * r0;
    const Lanes inside = b * b - a * c;
    const Lanes root = square_root(greater(inside, Lanes(0)));
    const Lanes q = select(b < 0.0, root - b, -b - root);
    const Lanes t0 = q / a;
    const Lanes t1 = select(q == 0.0, t0, c / q);
    const Lanes first = select(t1 < t0, t1, t0), second = select(t1 < t0, t0, t1);
    const LaneMask convex = a > 0.0;
    const LaneMask upwards = u.z * slope > 0.0;
    // An upright cylinder: the whole ray is inside, or none of it.
    const LaneMask parallel = (a == 0.0) & (b == 0.0);
    Lanes in = select(convex, first, select(upwards, second, Lanes(-kInfinity)));
    Lanes out = select(convex, second, select(upwards, Lanes(kInfinity), first));
    in = select(parallel, Lanes(-kInfinity), in);
    out = select(parallel, Lanes(kInfinity), out);
    // Between two roots the ray may be inside the mirrored nappe, which is not part of the tool.
    const LaneMask own_nappe = r0 + slope * (along - u.z * b / a) >= 0.0;
    const LaneMask exists =
        (convex & (inside >= 0.0) & own_nappe) | (~convex & ~parallel) | (parallel & (c <= 0.0));
    Lanes closest = Lanes(0);
    if (any(convex & ~exists)) closest = select(convex, closest_to(x, y, u, along, a), closest);
    return {in, out, exists, closest};
  }
  /// Returns the outward normal, of any length, at the point p = (x, y, t) with l = p·u: the
  /// gradient of ρ − (r0 + k l), where ρ is the distance from the axis.
  KERF_INLINE Vec3Lanes normal(const Vec3Lanes& p, Lanes l, const Vec3Lanes& u) const {
    const Vec3Lanes radial = p - u * l;
    return radial - u * (side.slope * square_root(dot(radial, radial)));
  }
  /// Distance of the point p from the side; below zero inside.
  KERF_INLINE Lanes clearance(const Vec3Lanes& p, Lanes l, const Vec3Lanes& u) const {
    const Vec3Lanes radial = p - u * l;
    return side.distance(square_root(dot(radial, radial)), l);
  }

 private:
  /// Returns the height at which ρ − (r0 + k l), convex along a ray, is least, for rays with A > 0:
  /// t0 + k u_z ρ1 / α with α = u_x² + u_y², t0 the height nearest to the axis, ρ0 the distance
  /// there and ρ1 = ρ0 √(α / A).
  KERF_INLINE Lanes closest_to(Lanes x, Lanes y, const Vec3Lanes& u, Lanes along, Lanes a) const {
    const Lanes lean2 = u.x * u.x + u.y * u.y;
    const Lanes t0 = along * u.z / lean2;
    const Lanes l0 = along + u.z * t0;
    const Lanes rho2 = greater(x * x + y * y + t0 * t0 - l0 * l0, Lanes(0));
    return t0 + side.slope * u.z * square_root(rho2 / (lean2 * a));
  }
};

/// The side of an arc piece, anchored at the height of the arc's center: F = √(m² + l²) − radius =
/// 0, where m is the distance from the tool's axis less center_r, at least zero. F is convex along
/// a ray, so Newton's method from outside approaches its roots monotonically. A disc that continues
/// the side without an edge is left out: the side bounds the piece there already.
struct ArcSide {
  double anchor, low, high, center_r, radius, reach, by_chord2;

  explicit ArcSide(const ArcPiece& p)
      : anchor(p.center_z_mm),
        low(is_level_below(p) ? -2 * p.radius_mm : p.z0_mm - p.center_z_mm),
        high(is_level_above(p) ? 2 * p.radius_mm : p.z1_mm - p.center_z_mm),
        center_r(p.center_r_mm),
        radius(p.radius_mm),
        reach(p.center_r_mm >= 0 ? p.center_r_mm + p.radius_mm
                                 : std::sqrt(std::max(0.0, p.radius_mm * p.radius_mm -
                                                               p.center_r_mm * p.center_r_mm))),
        by_chord2(0.125 / reach) {}

  KERF_INLINE SideSpan meet(Lanes x, Lanes y, const Vec3Lanes& u, Lanes along) const {
    const Lanes p2 = x * x + y * y;
    const Lanes ball2 = reach * reach - p2;
    const LaneMask near = ball2 >= 0.0;
    const Lanes half = square_root(select(near, ball2, Lanes(0)));
    Lanes in = -half, out = half;
    const LaneMask enters = approach(p2, u.z, along, near, in);
    if (any(enters)) approach(p2, u.z, along, enters, out);
    const Lanes closest = any(~enters) ? closest_to(p2, u.z, along) : half - half;
    return {in, out, enters, closest};
  }
  KERF_INLINE Vec3Lanes normal(const Vec3Lanes& p, Lanes l, const Vec3Lanes& u) const {
    const Vec3Lanes q = p - u * l;
    const Lanes rho = square_root(dot(q, q));
    const Lanes share = select(rho > center_r, 1 - center_r / rho, Lanes(0));
    return q * select(share == share, share, Lanes(1)) + u * l;
  }
  /// Distance of the point p from the side; below zero inside.
  KERF_INLINE Lanes clearance(const Vec3Lanes& p, Lanes l, const Vec3Lanes& u) const {
    const Vec3Lanes q = p - u * l;
    return circle_distance(center_r, radius, square_root(dot(q, q)), l).mm;
  }

 private:
  static constexpr int kSteps = 40;  ///< at a grazed arc each step halves the distance

  /// Returns the height at which a ray that misses is closest to the arc: where the slope of F
  /// along the ray changes sign. With θ the angle between the normal there and the axis, this is
  /// center_r |cos θ| away from the height nearest to the ball's center (less at a tip of the arc),
  /// for any gap.
  KERF_INLINE Lanes closest_to(Lanes p2, Lanes uz, Lanes along) const {
    const double farthest = std::abs(center_r);
    Lanes a = -farthest, b = farthest;
    for (double width = 2 * farthest; width > kArcClosestMm; width *= 0.5) {
      const Lanes t = (a + b) * 0.5;
      const Lanes l = along + uz * t;
      const Lanes rho = square_root(magnitude(p2 + t * t - l * l));
      const Lanes m = select(rho > center_r, rho - center_r, rho - rho);
      const LaneMask falling = select(rho > 0.0, m * (t - l * uz) / rho, rho) + l * uz < 0.0;
      a = select(falling, t, a);
      b = select(falling, b, t);
    }
    return (a + b) * 0.5;
  }

  /// Moves t by Newton's steps from outside towards the arc, in the lanes `asked`. Returns where
  /// the arc is hit.
  KERF_INLINE LaneMask approach(Lanes p2, Lanes uz, Lanes along, LaneMask asked, Lanes& t) const {
    LaneMask met = asked;
    LaneMask moving = asked;
    const LaneMask from_below = t <= 0.0;
    for (int i = 0; i < kSteps && any(moving); ++i) {
      const Lanes l = along + uz * t;
      const Lanes rho = square_root(greater(p2 + t * t - l * l, Lanes(0)));
      const CircleDistance<Lanes> d = circle_distance(center_r, radius, rho, l);
      const Lanes across = select(rho > 0.0, d.across * (t - l * uz) / rho, Lanes(0));
      const Lanes slope = (across + l * uz) / d.length;
      const LaneMask outside = d.mm > kArcFoundMm;
      const LaneMask closing = select(from_below, slope, -slope) < 0.0;
      met &= ~(moving & outside & ~closing);
      moving &= outside & closing;
      t = select(moving, t - d.mm / slope, t);
    }
    return met;
  }
};

}  // namespace kerf
