// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernel/sweep/end_reach.h"

// The same for stations that miss a ray, and what the reaches of all stations leave open.

namespace kerf {

/// Returns the share after a station that misses a ray, or before it with `sign` −1, in which no
/// point of the ray gets deeper into the slice than `depth_mm`. Unlike reach_of_miss, the bound
/// does not fall along the ray: the supporting plane is tilted towards points farther along it, and
/// where the ray passes a disc, points beyond it are near (kernel/sweep/README.md).
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
  const auto reach = [&](Lanes depth, Lanes fall, Lanes curve) __attribute__((always_inline)) {
    fall = greater(fall, Lanes(0));
    return 2 * depth / (fall + square_root(fall * fall + 2 * curve * depth));
  };

  // The tilt at the share s makes the plane rise along the ray by what the turn takes from it.
  const SideTilt tilt = side.tilt(p, l, u, n, off);
  const Lanes angle = turn / tilt.gain, first = slope / tilt.gain;
  const Lanes speed = square_root(dot(v, v)), side_speed = sign * dot(n, v);
  const Lanes tilted = reach(off + depth_mm - tilt.radius * first * first,
                             greater(side_speed, Lanes(0)) + first * (speed + tilt.radius * angle),
                             bend + angle * (1.25 * tilt.radius * angle + 2 * speed));
  const LaneMask rises = slope >= turn * length;
  const LaneMask tilts = (slope <= kFlatSlope) & (angle * length <= 0.4);
  const LaneMask inside = (l > side.low + kEdgeEpsilonMm) & (l < side.high - kEdgeEpsilonMm);
  Lanes least = select(rises & ~inside, reach(off + depth_mm, side_speed, bend), tilted);

  // Beyond a disc that the ray passes: the sum of both distances that does not fall along the ray.
  const Lanes weight = slope / magnitude(u.z), share = 1 / (1 + weight);
  const Lanes past = (side_speed - sign * n.z * dot(u, v) / u.z) * share +
                     turn * fastest_point(path) * length / magnitude(u.z);
  least = select(inside, least, lesser(least, reach(off * share + depth_mm, past, bend)));
  const LaneMask known =
      (off > 0.0) & (tilts | (rises & ~inside)) & (inside | (magnitude(u.z) >= kSteep));
  return select(known & (least > 0.0), least, Lanes(0));
}

/// Returns what stations that both miss a ray leave open.
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

/// Returns the reach, for the depth `depth_mm`, of a station that may hit the ray or miss it;
/// `sign` 1: after it, −1: before. Without `beside` a simpler bound is used for misses.
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

/// Returns what the stations leave open of the rays `asked`.
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

/// Narrows a gap by what an end excludes deeper than `depth_mm`. Returns the rays for which it did.
template <End end, class Side>
KERF_INLINE LaneMask close(const Side& side, const SlicePath& path, Lanes x, Lanes y, Gap& gap,
                           const FoundEnd& e, Lanes best, Lanes length, double depth_mm) {
  return gap.close(e.share - reach_of<end>(side, path, x, y, e, -1, best, length, depth_mm, true),
                   e.share + reach_of<end>(side, path, x, y, e, 1, best, length, depth_mm, true));
}

}  // namespace kerf
