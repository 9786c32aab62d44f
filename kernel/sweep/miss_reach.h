// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernel/sweep/end_reach.h"

// The reaches of stations that miss a ray, and the gaps that the reaches of all stations leave.

namespace kerf {

/// The deciding point of a ray that misses a slice.
struct MissedAt {
  Vec3Lanes anchor, p;  ///< the side's anchor relative to the tip; the point relative to the anchor
  Vec3Lanes u, n;       ///< the axis; the unit normal of the side below the point
  Lanes l, off;         ///< height on the axis, distance from the side
};

/// Returns the range of heights, relative to a point on the ray, in which the ray is within the
/// distance `far` of the axis. The range is arbitrary if the ray is parallel to the axis.
KERF_INLINE LaneSpan near_axis(const MissedAt& at, Lanes far) {
  const Lanes lean2 = 1 - at.u.z * at.u.z;
  const Lanes radial_z = at.p.z - at.l * at.u.z;
  const Lanes middle = -radial_z / lean2;
  const Lanes rho2 = dot(at.p, at.p) - at.l * at.l + radial_z * middle;
  const Lanes half = square_root(greater(far * far - rho2, Lanes(0)) / lean2);
  return {middle - half, middle + half};
}

/// As reach_beside, for rays that pass a disc. The bound is the distance from its plane, or a
/// weighted sum of this and the distance from the side that is constant along the ray. Both are
/// linear along the ray, so they are evaluated at the ends of the part that the slice can come to
/// hold within the stretch.
template <class Side>
KERF_INLINE Lanes reach_past_disc(const Side& side, const SlicePath& path, const MissedAt& at,
                                  double sign, Lanes length, double depth_mm) {
  const LaneSpan part = near_axis(at, side.widest + fastest_point(path) * length);
  const LaneMask below = at.l < (side.low + side.high) * 0.5;
  const Lanes off_disc = select(below, side.low - at.l, at.l - side.high);
  const Lanes out = select(below, Lanes(-1), Lanes(1));
  const Lanes outer = outer_bend(path, length);
  const Lanes disc_bend = path.search.disc_bend_mm + outer, side_bend = path.search.bend_mm + outer;
  Lanes by_disc = length, by_rim = length;
  const Lanes share = magnitude(at.n.z), weight = magnitude(at.u.z);
  for (const Lanes& t : {part.lo, part.hi}) {
    const Vec3Lanes v = path.frame.velocity(at.anchor + at.p + Vec3Lanes{Lanes(0), Lanes(0), t});
    const Lanes disc = off_disc + out * at.u.z * t, disc_fall = sign * out * dot(at.u, v);
    const Lanes rim = share * disc + weight * (at.off + at.n.z * t);
    const Lanes rim_fall = share * disc_fall + weight * sign * dot(at.n, v);
    by_disc = lesser(root_of(disc + depth_mm, disc_fall, disc_bend), by_disc);
    by_rim = lesser(root_of(rim + (share + weight) * depth_mm, rim_fall,
                            share * disc_bend + weight * side_bend),
                    by_rim);
  }
  return greater(by_disc, by_rim);
}

/// Returns the share after a station that misses a ray, or before it with `sign` −1, in which no
/// point of the ray gets deeper into the slice than `depth_mm`. Unlike that of reach_of_miss, the
/// bound does not fall along the ray: the supporting plane is tilted towards points farther along
/// it, and points beyond a disc that the ray passes are treated separately (kernel/sweep/bounds.md,
/// "Nothing deeper than the tolerance is missed", 4).
template <class Side>
KERF_INLINE Lanes reach_beside(const Side& side, const SlicePath& path, Lanes x, Lanes y,
                               const FoundEnd& e, double sign, Lanes length, double depth_mm) {
  const TurningFrame::Poses pose = path.frame.placed(e.share);
  const double turn = path.frame.turn;
  const Vec3Lanes& u = pose.u;
  const Vec3Lanes anchor = u * Lanes(side.anchor);
  const Vec3Lanes p{x - (pose.tip.x + anchor.x), y - (pose.tip.y + anchor.y),
                    e.z - (pose.tip.z + anchor.z)};
  const Lanes l = dot(p, u);
  const Vec3Lanes normal = side.normal(p, l, u);
  const Vec3Lanes n = normal * (1 / square_root(dot(normal, normal)));
  const Vec3Lanes v = path.frame.velocity(anchor + p);
  const Lanes off = side.clearance(p, l, u), slope = magnitude(n.z);
  const Lanes bend =
      std::max(path.search.bend_mm, path.search.disc_bend_mm) + outer_bend(path, length);

  // The tilt at the share s makes the plane rise along the ray by as much as the turn lowers it.
  const SideTilt tilt = side.tilt(p, l, u, n, off);
  const Lanes angle = turn / tilt.gain, first = slope / tilt.gain;
  const Lanes speed = square_root(dot(v, v)), side_speed = sign * dot(n, v);
  const Lanes tilted =
      root_of(off + depth_mm - tilt.radius * first * first,
              greater(side_speed, Lanes(0)) + first * (speed + tilt.radius * angle),
              bend + angle * (1.25 * tilt.radius * angle + 2 * speed));
  const LaneMask rises = slope >= turn * length;
  const LaneMask tilts = (slope <= kFlatSlope) & (angle * length <= 0.4);
  const LaneMask inside = (l > side.low + kEdgeEpsilonMm) & (l < side.high - kEdgeEpsilonMm);
  Lanes least = select(rises & ~inside, root_of(off + depth_mm, side_speed, bend), tilted);

  // Beyond a disc that the ray passes: the sum of both distances that does not fall along the ray.
  const Lanes weight = slope / magnitude(u.z), share = 1 / (1 + weight);
  const Lanes past = (side_speed - sign * n.z * dot(u, v) / u.z) * share +
                     turn * fastest_point(path) * length / magnitude(u.z);
  least = select(inside, least, lesser(least, root_of(off * share + depth_mm, past, bend)));
  const LaneMask known =
      (off > 0.0) & (tilts | (rises & ~inside)) & (inside | (magnitude(u.z) >= kSteep));
  least = select(known & (least > 0.0), least, Lanes(0));
  const LaneMask across = magnitude(u.z) < kSteep;
  if (!any(across)) return least;
  const Lanes past_disc =
      reach_past_disc(side, path, {anchor, p, u, n, l, off}, sign, length, depth_mm);
  return select(across & (past_disc > least), past_disc, least);
}

/// Returns the gap that stations that both miss a ray leave.
template <class Side>
KERF_INLINE Gap gap_beside(const Side& side, const SlicePath& path, Lanes x, Lanes y,
                           const Stretch& stretch) {
  const Lanes length = stretch.to - stretch.from;
  const FoundEnd first = FoundEnd::of<End::kLower>(stretch.from, stretch.first);
  const FoundEnd last = FoundEnd::of<End::kLower>(stretch.to, stretch.last);
  const double depth = tolerance_of(path);
  return {stretch.from + reach_beside(side, path, x, y, first, 1, length, depth),
          stretch.to - reach_beside(side, path, x, y, last, -1, length, depth)};
}

/// Returns the reach, for the depth `depth_mm`, of a station that may hit the ray or miss it: after
/// it with `sign` 1, before it with −1. Without `beside`, misses use a simpler bound.
template <End end, class Side>
KERF_INLINE Lanes reach_of(const Side& side, const SlicePath& path, Lanes x, Lanes y,
                           const FoundEnd& e, double sign, Lanes best, Lanes length,
                           double depth_mm, bool beside) {
  // No point gets deeper than it can move.
  Lanes reach = depth_mm / fastest_point(path);
  const Lanes outwards = sign * e.advance;
  if (any(e.hit)) {
    const Lanes of_hit = reach_of_hit<end>(path, e, outwards, best, length, depth_mm);
    reach = select(e.hit & (of_hit > reach), of_hit, reach);
  }
  if (!any(~e.hit)) return reach;
  const double top = path.search.top_mm;
  Lanes of_miss = reach_of_miss(path, e, outwards, depth_mm, top, length);
  if (beside) of_miss = greater(reach_beside(side, path, x, y, e, sign, length, depth_mm), of_miss);
  return select(e.hit, reach, of_miss);
}

/// Returns the gap that the stations leave in the rays `asked`.
template <End end, class Side>
KERF_INLINE Gap gap_of(const Side& side, const SlicePath& path, Lanes x, Lanes y,
                       const Stretch& stretch, Lanes best, LaneMask asked) {
  const Lanes length = stretch.to - stretch.from;
  const FoundEnd first = FoundEnd::of<end>(stretch.from, stretch.first);
  const FoundEnd last = FoundEnd::of<end>(stretch.to, stretch.last);
  const double depth = tolerance_of(path);
  Gap gap;
  for (const bool beside : {false, true}) {
    gap = {stretch.from + reach_of<end>(side, path, x, y, first, 1, best, length, depth, beside),
           stretch.to - reach_of<end>(side, path, x, y, last, -1, best, length, depth, beside)};
    if (!any(asked & gap.open() & ~(first.hit & last.hit))) return gap;
  }
  return gap;
}

/// Narrows a gap by the reach of an end for the depth `depth_mm`. Returns the rays for which it
/// did.
template <End end, class Side>
KERF_INLINE LaneMask close(const Side& side, const SlicePath& path, Lanes x, Lanes y, Gap& gap,
                           const FoundEnd& e, Lanes best, Lanes length, double depth_mm) {
  return gap.close(e.share - reach_of<end>(side, path, x, y, e, -1, best, length, depth_mm, true),
                   e.share + reach_of<end>(side, path, x, y, e, 1, best, length, depth_mm, true));
}

}  // namespace kerf
