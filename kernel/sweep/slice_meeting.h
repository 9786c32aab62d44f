// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>

#include "kernel/math/span.h"
#include "kernel/sweep/piece_side.h"
#include "kernel/sweep/slice_path.h"

namespace kerf {

/// Sine of the angle between ray and discs from which on the discs, instead of the side, are used
/// to estimate the distance between ray and piece.
constexpr double kSteep = 0.5;

/// Intersection of eight rays with a piece, each at its own share of the motion.
struct Meeting {
  Lanes lo, hi;  ///< heights of the interval; for misses, both are the height of the deciding point
  LaneMask hit;
  Lanes side_lo, side_hi;  ///< of the side, continued beyond the discs; lo > hi for misses
  LaneMask on_side;        ///< for hits: the end is on the side, not on a disc
  LaneMask enters_side, leaves_side;  ///< for hits: the lower, or upper, end is on the side
  Lanes within;   ///< distance along the ray of the side's end from the nearer disc; < 0 beyond it
  Lanes through;  ///< depth of the ray in the piece; < 0: distance by which it misses
  /// Speed of the end outwards, or of the piece towards a ray that misses it. If > 0, the end is
  /// farther out later in the motion; if < 0, it was farther out earlier.
  Lanes advance;
  Lanes beyond;     ///< advance of the other surface, disc or side, that may end rays here; or 0
  Lanes clearance;  ///< lower bound of the distance between ray and piece; 0 for hits
  Lanes off_side;   ///< of a ray that misses the side between the discs: lower bound of the
                    ///< distance, which shrinks at most as fast as the piece moves there
  Lanes upright;    ///< advance / upright is the speed of the end along the ray; 0 for misses
  Lanes normal2;    ///< squared length of the normal along which both are measured
};

/// Sets the clearance of rays that miss the piece. `p` is the deciding point, at the height `l` on
/// the axis u. The side's normal there has the component nz along the rays.
template <class Side>
KERF_INLINE void note_clearance(Meeting& m, const Side& side, const SideSpan& span,
                                const Vec3Lanes& p, const Vec3Lanes& u, Lanes l, Lanes nz,
                                LaneMask steep) {
  const LaneMask by_side = ~m.hit & (steep | ~span.exists);
  const Lanes off_side = side.clearance(p, l, u);
  // Along the ray beyond a disc, the distance from the side shrinks at most at unit rate, while the
  // distance from the disc grows at the rate `slope`. Beyond the side's end it is the reverse.
  const Lanes slope = magnitude(u.z);
  const Lanes past_disc = off_side * (slope / (1 + slope));
  const Lanes off_disc = greater(side.low - l, l - side.high);
  const Lanes leaves = magnitude(nz) / square_root(m.normal2);
  const Lanes past_end = off_disc * (leaves / (leaves + slope));
  const LaneMask passes = ~span.exists & (p.z == span.closest);
  const Lanes least = select(passes, off_side, select(by_side, past_disc, past_end));
  m.clearance = select(~m.hit & (least > 0.0), least, Lanes(0));
  // If a disc decides, the sum of the distances from side and disc that is constant along the ray
  // is a bound. `past_disc` is its least value.
  m.off_side = select(by_side & (off_side > 0.0), select(passes, off_side, past_disc), Lanes(0));
  m.through = select(span.exists, m.through, -off_side);
}

/// Intersection of eight rays with a piece, each at a pose of its own. Heights are relative to the
/// piece's anchor.
struct Crossing {
  Vec3Lanes anchor;     ///< relative to the tip
  Lanes px, py, along;  ///< position of the ray from the anchor, its component along the axis
  Lanes inverse_uz;
  Lanes disc_in, disc_out;  ///< heights between the planes of the discs
  SideSpan span;
  LaneMask below, above;  ///< the ray leaves the side before the discs, or enters it beyond them
  LaneMask hit;
  Lanes in, out;  ///< interval; empty unless hit
};

/// Intersects eight rays with a piece. `end` is computed exactly, the other end up to the disc
/// there. The interval is the one that the pose removes: it depends on the piece, the pose and the
/// ray alone (kernel/sweep/README.md, "A pose"). An upper end above the height `top_mm` may be
/// anywhere above it.
template <End end, class Side>
KERF_INLINE Crossing cross_piece(const Side& side, const TurningFrame::Poses& pose, Lanes x,
                                 Lanes y, double top_mm = std::numeric_limits<double>::infinity()) {
  const Vec3Lanes& u = pose.u;
  Crossing c;
  c.anchor = u * Lanes(side.anchor);
  c.px = x - (pose.tip.x + c.anchor.x);
  c.py = y - (pose.tip.y + c.anchor.y);
  c.along = c.px * u.x + c.py * u.y;
  // A ray perpendicular to the axis crosses the planes of the discs far away.
  c.inverse_uz = 1 / select(magnitude(u.z) > kAxisAlongRayMin, u.z, Lanes(kAxisAlongRayMin));
  const Lanes to_low = (side.low - c.along) * c.inverse_uz;
  const Lanes to_high = (side.high - c.along) * c.inverse_uz;
  c.disc_in = lesser(to_low, to_high);
  c.disc_out = greater(to_low, to_high);
  c.span = side.template meet<end>(
      c.px, c.py, u, c.along,
      {c.disc_in, c.disc_out, c.inverse_uz, top_mm - (pose.tip.z + c.anchor.z)});
  c.below = c.span.exists & (c.span.out < c.disc_in);
  c.above = c.span.exists & (c.span.in > c.disc_out);
  c.hit = c.span.exists & ~c.below & ~c.above;
  c.in = greater(c.span.in, c.disc_in);
  c.out = lesser(c.span.out, c.disc_out);
  // Equal to meet_discs, to the bit.
  const DiscPlanes& d = side.planes;
  const Lanes p2 = c.px * c.px + c.py * c.py;
  const Lanes t0 = (d.low - c.along) * c.inverse_uz, t1 = (d.high - c.along) * c.inverse_uz;
  const LaneMask upright = c.hit & (u.z > 0.0);
  c.in = select(upright & (p2 + t0 * t0 - d.low * d.low < d.low_radius2), t0, c.in);
  c.out = select(upright & (p2 + t1 * t1 - d.high * d.high < d.high_radius2), t1, c.out);
  return c;
}

/// Includes the intervals that a piece at a pose removes from eight rays, below the height
/// `top_mm`.
template <class Side>
KERF_INLINE void include_pose(LaneSpan& span, const Side& side, const ToolPose& pose, Lanes x,
                              Lanes y, double top_mm) {
  TurningFrame::Poses at{};
  TurningFrame::put(at, every_lane(), pose);
  const Crossing c = cross_piece<End::kLower>(side, at, x, y, top_mm);
  const Lanes middle = at.tip.z + c.anchor.z, lo = middle + c.in, hi = middle + c.out;
  span.lo = select(c.hit & (lo < span.lo), lo, span.lo);
  span.hi = select(c.hit & (hi > span.hi), hi, span.hi);
}

/// As include_pose, for a piece that has been removed from the stock at this pose. For a ray inside
/// it, only a point and the ends on discs, which a neighbor may continue, are included, unless some
/// ray needs the full test.
template <class Side>
KERF_INLINE void include_gone(LaneSpan& span, const Side& side, const ToolPose& pose, Lanes x,
                              Lanes y, double top_mm) {
  const Vec3 u = pose.axis, anchor = pose.tip_mm + u * side.anchor;
  if (!(u.z >= 0)) return include_pose(span, side, pose, x, y, top_mm);
  const Lanes px = x - anchor.x, py = y - anchor.y;
  const Lanes along = px * u.x + py * u.y, p2 = px * px + py * py;
  const double inverse_uz = 1 / (u.z > kAxisAlongRayMin ? u.z : kAxisAlongRayMin);
  const DiscPlanes& d = side.planes;
  const Lanes t0 = (d.low - along) * inverse_uz, t1 = (d.high - along) * inverse_uz;
  const Lanes at0 = p2 + t0 * t0 - d.low * d.low - d.low_radius2;
  const Lanes at1 = p2 + t1 * t1 - d.high * d.high - d.high_radius2;
  const LaneMask upright = Lanes(u.z) > 0.0;
  const LaneMask enters = upright & (at0 < 0.0), leaves = upright & (at1 < 0.0);
  // The height nearest to the anchor, between the discs.
  const Lanes to_low = (side.low - along) * inverse_uz, to_high = (side.high - along) * inverse_uz;
  const Lanes t = lesser(greater(Lanes(0), to_low), to_high);
  const Lanes l = along + u.z * t;
  const LaneMask inside = side.holds(p2 + t * t - l * l, l);
  const double level2 = u.x * u.x + u.y * u.y, beyond = side.widest + kRectangleMarginMm;
  const Lanes aside = px * u.y - py * u.x;
  const LaneMask far =
      level2 > 0 ? aside * aside > beyond * beyond * level2 : p2 > Lanes(beyond * beyond);
  // Near the end of a ray that passes the rim of a disc, there may be an end of a neighbor.
  const LaneMask at_rim = ((at0 >= 0.0) & (at0 < kRimMm2)) | ((at1 >= 0.0) & (at1 < kRimMm2));
  if (any(~far & (at_rim | ~(enters | leaves | inside)))) {
    return include_pose(span, side, pose, x, y, top_mm);
  }
  include(span, inside, anchor.z + t);
  include(span, enters, anchor.z + t0);
  include(span, leaves, anchor.z + t1);
}

/// Intersects eight rays with a piece at eight poses of its path. The speeds are computed for
/// `end`.
template <End end, class Side>
KERF_INLINE Meeting meet_at(const Side& side, const SlicePath& path, Lanes x, Lanes y,
                            const TurningFrame::Poses& pose) {
  const Crossing crossing = cross_piece<end>(side, pose, x, y);
  const Vec3Lanes &u = pose.u, &anchor = crossing.anchor;
  const SideSpan& span = crossing.span;
  const Lanes px = crossing.px, py = crossing.py, along = crossing.along;
  const Lanes disc_in = crossing.disc_in, disc_out = crossing.disc_out;
  const Lanes in = crossing.in, out = crossing.out;
  const LaneMask below = crossing.below, hit = crossing.hit;

  // The deciding point: the end of the interval, or where side and discs are closest to
  // overlapping.
  const LaneMask steep = magnitude(u.z) >= kSteep, misses = ~hit;
  const LaneMask on_side = end == End::kLower ? span.in >= disc_in : span.out <= disc_out;
  Lanes t = select(span.exists, select(below, span.out, span.in), span.closest);
  t = select(steep, lesser(greater(t, disc_in), disc_out), t);
  t = select(hit, end == End::kLower ? in : out, t);
  const Vec3Lanes p{px, py, t};
  const Lanes l = along + u.z * t;
  const Vec3Lanes n = side.normal(p, l, u);
  const Vec3Lanes v = path.frame.velocity(anchor + p);
  const Lanes side_speed = dot(n, v), axis_speed = dot(u, v);
  const Lanes outward = end == End::kLower ? -axis_speed : axis_speed;
  const Lanes disc_speed = select(u.z < 0.0, -outward, outward);
  // For misses: the speed at which the gap closes, at the nearer disc or at the side's end.
  Lanes gap_speed = side_speed;
  if (any(misses)) {
    const Lanes from_disc = side_speed - n.z * axis_speed * crossing.inverse_uz;
    const Lanes rise = select(span.exists, u.z * side_speed / n.z, Lanes(0)) - axis_speed;
    const Lanes from_side = select(span.exists, select(l < side.low, rise, -rise), side_speed);
    gap_speed = select(steep, from_disc, from_side);
  }

  Meeting m;
  m.hit = hit;
  m.on_side = on_side;
  // The end other than `end` is computed up to the disc.
  m.enters_side = span.in > disc_in;
  m.leaves_side = span.out < disc_out;
  const Lanes side_end = end == End::kLower ? span.in : span.out;
  const Lanes above_in = side_end - disc_in, below_out = disc_out - side_end;
  m.within = lesser(above_in, below_out);
  // The ray leaves the piece near the other disc.
  const LaneMask ends_here = end == End::kLower ? above_in < below_out : below_out < above_in;
  const Lanes by_discs = lesser(span.out - disc_in, disc_out - span.in);
  m.through = lesser(by_discs * (u.x * u.x + u.y * u.y), span.depth);
  const Lanes middle = pose.tip.z + anchor.z;
  const Lanes none = std::numeric_limits<double>::infinity();
  m.side_lo = middle + select(span.exists, span.in, none);
  m.side_hi = middle + select(span.exists, span.out, -none);
  m.lo = middle + select(hit, in, t);
  m.hi = middle + select(hit, out, t);
  m.advance = select(hit, select(on_side, side_speed, disc_speed), gap_speed);
  m.beyond = select(ends_here, select(on_side, disc_speed, side_speed), Lanes(0));
  m.upright = select(hit, select(on_side, n.z, u.z), Lanes(0));
  m.normal2 = select(hit & ~on_side, Lanes(1), dot(n, n));
  m.clearance = m.off_side = Lanes(0);
  if (!any(misses)) return m;
  note_clearance(m, side, span, p, u, l, n.z, steep);
  return m;
}

/// As above, at eight shares.
template <End end, class Side>
KERF_INLINE Meeting meet(const Side& side, const SlicePath& path, Lanes x, Lanes y, Lanes share) {
  return meet_at<end>(side, path, x, y, path.frame.placed(share));
}

/// Returns `m`, evaluated at a share for the lower ends, with the surface and the speed of the
/// upper ends of hits. Its `within` and `beyond` are those of the lower ends.
template <class Side>
KERF_INLINE Meeting at_upper_end(const Side& side, const SlicePath& path, Lanes x, Lanes y,
                                 double share, const Meeting& m) {
  TurningFrame::Poses between;
  const TurningFrame::Poses& pose = path.pose(share, between);
  const Vec3Lanes& u = pose.u;
  const Vec3Lanes anchor = u * Lanes(side.anchor);
  const Vec3Lanes p{x - (pose.tip.x + anchor.x), y - (pose.tip.y + anchor.y),
                    m.hi - (pose.tip.z + anchor.z)};
  const Lanes l = dot(p, u);
  const Vec3Lanes n = side.normal(p, l, u);
  const Vec3Lanes v = path.frame.velocity(anchor + p);
  const Lanes axis_speed = dot(u, v);
  const Lanes disc_speed = select(u.z < 0.0, -axis_speed, axis_speed);
  Meeting upper = m;
  upper.on_side = m.leaves_side;
  upper.advance = select(m.hit, select(m.leaves_side, dot(n, v), disc_speed), m.advance);
  upper.upright = select(m.hit, select(m.leaves_side, n.z, u.z), Lanes(0));
  upper.normal2 = select(m.hit, select(m.leaves_side, dot(n, n), Lanes(1)), m.normal2);
  return upper;
}

}  // namespace kerf
