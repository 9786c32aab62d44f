// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>

#include "kernel/math/span.h"
#include "kernel/sweep/slice_meeting.h"

// How far along a motion an end of a slice rules out that points deeper in the sweep than the
// tolerance are missed (kernel/sweep/bounds.md, "Nothing deeper than the tolerance is missed").

namespace kerf {

/// Intervals of shares between two stations, and the intersections there.
struct Stretch {
  Lanes from, to;
  const Meeting &first, &last;
};

/// The values of an intersection of eight rays, each at its own share, that a reach needs.
struct FoundEnd {
  Lanes share, z;
  Lanes advance, upright, normal2, clearance, off_side;  ///< as in Meeting
  LaneMask on_side, hit;                                 ///< as in Meeting

  template <End end>
  KERF_INLINE static FoundEnd of(Lanes share, const Meeting& m) {
    FoundEnd e;
    e.share = share;
    e.z = end == End::kLower ? m.lo : m.hi;
    e.advance = m.advance;
    e.upright = m.upright;
    e.normal2 = m.normal2;
    e.clearance = m.clearance;
    e.off_side = m.off_side;
    e.on_side = m.on_side;
    e.hit = m.hit;
    return e;
  }
  /// Replaces the ends in the lanes `where` by those of `other`.
  KERF_INLINE void take(LaneMask where, const FoundEnd& other) {
    share = select(where, other.share, share);
    z = select(where, other.z, z);
    advance = select(where, other.advance, advance);
    upright = select(where, other.upright, upright);
    normal2 = select(where, other.normal2, normal2);
    clearance = select(where, other.clearance, clearance);
    off_side = select(where, other.off_side, off_side);
    on_side = (where & other.on_side) | (~where & on_side);
    hit = (where & other.hit) | (~where & hit);
  }
};

/// Returns the greatest depth in the sweep that may be missed.
KERF_INLINE double tolerance_of(const SlicePath& path) {
  return path.search.missed_mm + path.search.search_mm;
}

/// Returns the additional bend of a point's path, within a stretch of the length `length`, if the
/// slice holds the point at another share of the stretch only.
KERF_INLINE Lanes outer_bend(const SlicePath& path, Lanes length) {
  return path.frame.turn * path.frame.turn * path.speed_max_mm * length;
}

/// Returns the greatest speed, at any share, of a point that the slice holds at some share.
KERF_INLINE double fastest_point(const SlicePath& path) {
  return path.speed_max_mm * (1 + path.frame.turn);
}

/// Returns the share x up to which the distance off − fall x − bend x²/2 does not fall below zero,
/// or 0 if `off` is not positive.
KERF_INLINE Lanes root_of(Lanes off, Lanes fall, Lanes bend) {
  const Lanes root = square_root(fall * fall + 2 * bend * off);
  const LaneMask falls = fall > 0.0;
  const Lanes share = select(falls, 2 * off, root - fall) / select(falls, fall + root, bend);
  return select(off > 0.0, share, Lanes(0));
}

/// Returns the hits at the first (`sign` −1) or the last pose (1) whose end is outermost there: it
/// moves outwards towards that pose faster than the bend can compensate (kernel/sweep/bounds.md,
/// "Ends at the last pose, or the first").
KERF_INLINE LaneMask outermost_at(const SlicePath& path, const Meeting& m, double sign) {
  const Lanes scale = 1 / square_root(m.normal2);
  const double turn = path.frame.turn;
  const double bend = path.search.bend_mm + turn * turn * path.speed_max_mm;
  const LaneMask bound = m.on_side | (path.search.shows_disc ? every_lane() : ~every_lane());
  return m.hit & bound & (sign * m.advance * scale >= 0.5 * bend + kRecedingMm) &
         (magnitude(m.upright) * scale >= turn);
}

/// Returns the share after an end in which no point of the ray at `best` or farther out gets deeper
/// into the slice than `depth_mm`. With −advance for `outwards`, returns the share before it.
/// `best` is the outermost end known, `length` the length of the stretch.
template <End end>
KERF_INLINE Lanes reach_of_hit(const SlicePath& path, const FoundEnd& e, Lanes outwards, Lanes best,
                               Lanes length, double depth_mm) {
  const double turn = path.frame.turn;
  const Lanes scale = 1 / square_root(e.normal2);
  const Lanes slope = magnitude(e.upright) * scale, speed = outwards * scale;
  const Lanes bend =
      select(e.on_side, Lanes(path.search.bend_mm), Lanes(path.search.disc_bend_mm)) +
      outer_bend(path, length);
  const auto within = [&](Lanes rise) __attribute__((always_inline)) {
    return root_of(slope * rise + depth_mm, speed + turn * rise, bend);
  };
  const Lanes rise = magnitude(e.z - best);
  const Lanes reach = within(rise);
  // A wall that tips past the ray may reach points farther out earlier than that at `best`.
  const LaneMask tips = e.hit & ~(slope >= turn * lesser(reach, length));
  if (!any(tips)) return reach;
  const double top = path.search.top_mm;
  const Lanes beyond = end == End::kLower ? best - path.lowest_mm : top - best;
  return select(tips, lesser(within(rise + greater(beyond, Lanes(0))), reach), reach);
}

/// Returns the share after a station that misses a ray in which no point of the ray below `top`
/// gets deeper into the slice than `depth_mm`. With −advance for `closing`, returns the share
/// before it.
KERF_INLINE Lanes reach_of_miss(const SlicePath& path, const FoundEnd& e, Lanes closing,
                                double depth_mm, double top, Lanes length) {
  const Lanes along_ray = greater(magnitude(e.z - path.lowest_mm), magnitude(top - e.z));
  const Lanes bend =
      std::max(path.search.bend_mm, path.search.disc_bend_mm) + outer_bend(path, length);
  const Lanes off = select(e.off_side > 0.0, greater(e.off_side + depth_mm, Lanes(0)), Lanes(0));
  const Lanes fall =
      greater(closing, Lanes(0)) / square_root(e.normal2) + path.frame.turn * along_ray;
  return greater(root_of(off, fall, bend), (e.clearance + depth_mm) / fastest_point(path));
}

/// Returns the rays whose ends, `apart` along the ray, are on one disc at both stations of a
/// stretch, and in between are farther out by at most the tolerance. The distance of a point from a
/// plane leaves its chord by the bend at most.
KERF_INLINE LaneMask held_by_disc(const SlicePath& path, Lanes apart, Lanes length) {
  const double uz = std::abs(path.frame.u.z) - path.frame.turn;
  const Lanes bend = (path.search.disc_bend_mm + outer_bend(path, length)) * length * length;
  const Lanes left = greater(bend - 2 * uz * apart, Lanes(0));
  return (left * left <= 8 * tolerance_of(path) * bend) & (Lanes(uz) > 0.0);
}

/// The shares of a stretch between `low` and `high` that no reach covers.
struct Gap {
  Lanes low, high;

  KERF_INLINE LaneMask open() const { return ~(low >= high); }
  /// Narrows the gap by an end that covers the shares from `from` to `to`, if these adjoin the
  /// covered ones. Returns the rays for which they do.
  KERF_INLINE LaneMask close(Lanes from, Lanes to) {
    const LaneMask joins_low = from <= low, joins_high = to >= high;
    low = select(joins_low, greater(low, to), low);
    high = select(joins_high, lesser(high, from), high);
    return joins_low | joins_high;
  }
};

/// Returns the rays for which the reaches of the stations plainly cover the stretch: one reach
/// alone is long enough; or one end moves inwards, which has the reach of the bend, and that of the
/// other station covers the rest; or the piece is too far from the ray at both. All stretches have
/// the same length.
template <End end>
KERF_INLINE LaneMask plainly_covered(const SlicePath& path, const Stretch& stretch, Lanes best) {
  const Meeting &first = stretch.first, &last = stretch.last;
  const Lanes length = stretch.to - stretch.from;
  const double tolerance = tolerance_of(path), turn = path.frame.turn;
  const Lanes bend =
      std::max(path.search.bend_mm, path.search.disc_bend_mm) + outer_bend(path, length);
  const Lanes covered = std::sqrt(2 * tolerance / bend[0]);
  const Lanes rest = greater(length - covered, Lanes(0));
  struct Covers {
    LaneMask upright;  // the wall does not tip past the ray
    LaneMask rest, whole;
  };
  const auto covers = [&](const Meeting& m, Lanes outwards) __attribute__((always_inline)) {
    const Lanes normal = square_root(m.normal2), slope = magnitude(m.upright);
    const Lanes rise = magnitude((end == End::kLower ? m.lo : m.hi) - best);
    const Lanes off = slope * rise + tolerance * normal, fall = outwards + turn * rise * normal;
    const Lanes curve = 0.5 * bend * normal;
    return Covers{m.hit & (slope >= turn * length * normal), off >= (fall + curve * rest) * rest,
                  off >= (fall + curve * length) * length};
  };
  const Covers by_first = covers(first, first.advance), by_last = covers(last, -last.advance);
  const LaneMask all = rest <= 0.0, far = first.clearance + last.clearance + 2 * tolerance >=
                                          fastest_point(path) * length;
  return (by_first.upright & (first.advance <= 0.0) & (all | (by_last.upright & by_last.rest))) |
         (by_last.upright & (last.advance >= 0.0) & (all | (by_first.upright & by_first.rest))) |
         (by_first.upright & by_first.whole) | (by_last.upright & by_last.whole) |
         (~first.hit & ~last.hit & far);
}

}  // namespace kerf
