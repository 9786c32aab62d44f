// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <limits>
#include <vector>

#include "kernel/sweep/column_block.h"
#include "kernel/sweep/end_reach.h"
#include "kernel/sweep/piece_side.h"
#include "kernel/sweep/slice_path.h"

// Most rays below a mill enter it through the lower disc, all along the motion. Their ends are then
// those of a plane, and nothing about the side has to be known.

namespace kerf {

/// Eight rays and a slice at one pose. Only `usable` is set unless all rays enter through the lower
/// disc.
struct DiscMeeting {
  Lanes lo, hi;  ///< heights in the planes of the lower and the upper disc; `hi` is at least
                 ///< `top` where the ray is inside there
  Lanes out_lo, out_hi;  ///< speeds of the discs outwards
  LaneMask covers;       ///< the ray is inside the slice at the height `top`
  LaneMask usable;  ///< the ray enters through the lower disc, and leaves through the upper one
                    ///< or above `top`
};

template <class Side>
KERF_INLINE DiscMeeting meet_discs(const Side& side, const DiscPose& pose, Lanes x, Lanes y,
                                   double top) {
  const Lanes px = x - pose.center.x, py = y - pose.center.y;
  const Lanes along = px * pose.u.x + py * pose.u.y, p2 = px * px + py * py;
  const Lanes speed = pose.speed + px * pose.by_place.x + py * pose.by_place.y;
  const DiscPlanes& discs = pose.discs;
  DiscMeeting m;
  const Lanes t0 = (discs.low - along) * pose.inverse_uz;
  const LaneMask enters = p2 + t0 * t0 - discs.low * discs.low < discs.low_radius2;
  m.usable = enters;
  if (any(~enters)) return m;
  m.lo = pose.center.z + t0;
  m.out_lo = -(speed + t0 * pose.by_place.z);
  const double t = top - pose.center.z;
  const Lanes l = along + t * pose.u.z;
  m.covers = (l >= discs.low) & (l <= discs.high) & side.holds(p2 + t * t - l * l, l);
  m.hi = Lanes(top);
  m.out_hi = Lanes(0);
  m.usable = m.covers;
  if (!any(~m.covers)) return m;
  const Lanes t1 = (discs.high - along) * pose.inverse_uz;
  m.usable = m.covers | (p2 + t1 * t1 - discs.high * discs.high < discs.high_radius2);
  m.hi = select(m.covers, m.hi, pose.center.z + t1);
  m.out_hi = speed + t1 * pose.by_place.z;
  return m;
}

/// The ends of eight rays on a disc at two successive stations: their outward speeds there, and by
/// how much the last end is farther out than the first.
struct DiscEnds {
  Lanes out_from, out_to, beyond;

  /// Returns the rays whose end moves outwards first and inwards last.
  KERF_INLINE LaneMask turn() const { return (out_from > 0.0) & (out_to < 0.0); }
};

/// Returns those of the remaining rays for which the end of a disc may be farther out between two
/// stations, the share `length` apart, by more than the search may miss.
KERF_INLINE LaneMask may_exceed(const SlicePath& path, double length, const DiscEnds& ends) {
  const double covered = std::sqrt(2 * path.search.missed_mm / path.search.bend_mm);
  const double left = length - covered;
  if (!path.search.checked || !(left > 0)) return ~every_lane();
  // If `beyond` > 0, the bound is that of the first station; else that of the last.
  const Lanes rise = magnitude(ends.beyond);
  const Lanes inwards = select(ends.beyond > 0.0, ends.out_from, -ends.out_to);
  const Lanes fall =
      greater(inwards, Lanes(0)) + path.frame.turn * rise + 0.5 * path.search.bend_mm * left;
  return ~ends.turn() & ~(path.discs.least_uz * rise - fall * left >= -path.search.missed_mm);
}

/// The outermost ends of rays on a disc, between two stations.
struct DiscTurn {
  Lanes z;
  LaneMask found;  ///< it is that end, and is within the disc
};

/// Finds the ends that turn from outwards to inwards after the share `from`. The speed of a plane
/// is almost linear in the share, so linear interpolation of its zero suffices.
KERF_INLINE DiscTurn turn_on_disc(const SlicePath& path, Lanes x, Lanes y, double from,
                                  double length, const DiscEnds& ends, End end) {
  const DiscPose& first = path.discs.poses.front();
  const bool lower = end == End::kLower;
  const double height = lower ? first.discs.low : first.discs.high;
  const Lanes after = length * (ends.out_from / (ends.out_from - ends.out_to));
  const TurningFrame::Poses pose = path.frame.placed(from + after);
  const Vec3Lanes& u = pose.u;
  const Vec3Lanes anchor = u * Lanes(path.discs.anchor);
  const Lanes px = x - (pose.tip.x + anchor.x), py = y - (pose.tip.y + anchor.y);
  const Lanes t = (height - px * u.x - py * u.y) / u.z;
  const Lanes speed = dot(u, path.frame.velocity(anchor + Vec3Lanes{px, py, t}));
  const double radius2 = lower ? first.discs.low_radius2 : first.discs.high_radius2;
  const LaneMask within = px * px + py * py + t * t - height * height < radius2;
  const LaneMask settled = magnitude(speed) * length <= path.search.search_mm * u.z;
  const double covered =
      path.search.checked ? std::sqrt(2 * path.search.missed_mm / path.search.bend_mm) : length;
  const LaneMask reaches = (after <= covered) & (length - after <= covered);
  return {pose.tip.z + anchor.z + t, within & settled & reaches};
}

/// Adds the intervals of the rays `open` of a row whose rays all enter the slice through its lower
/// disc and leave it through the upper one or above the grid. Whether they do must not depend on
/// the stock, because the other formulas differ in the last bits. `known` describes all rows of the
/// block. Returns false if there are other rays, or an end has to be searched; some of the row's
/// intervals may then have been added.
template <class Side>
KERF_INLINE bool add_disc_row(const Side& side, const SlicePath& path, Lanes y, int row,
                              LaneMask open, const RowBits& known, ColumnBlock& block) {
  const Lanes x = block.x_mm, none = std::numeric_limits<double>::infinity();
  const double top = path.search.top_mm;
  const std::vector<DiscPose>& poses = path.discs.poses;
  if ((known.ahead >> row & 1) != 0) {
    const DiscMeeting m = meet_discs(side, poses.back(), x, y, top);
    if (any(~m.usable)) return false;
    block.add(row, select(open, m.lo, none), select(open, m.hi, -none));
    return true;
  }
  if (poses.size() == 1) return false;
  const double length = 1 / double(poses.size() - 1);
  DiscMeeting first = meet_discs(side, poses[0], x, y, top);
  if (any(~first.usable)) return false;
  for (std::size_t k = 1; k < poses.size(); ++k) {
    const DiscMeeting last = meet_discs(side, poses[k], x, y, top);
    const double from = double(k - 1) * length;
    LaneMask bad = ~last.usable | (first.lo > last.hi) | (last.lo > first.hi);
    Lanes lo = lesser(first.lo, last.lo), hi = greater(first.hi, last.hi);
    bad |= ~held_by_disc(path, magnitude(first.lo - last.lo), length);
    if ((known.hides_entry >> row & 1) == 0) {
      const DiscEnds ends{first.out_lo, last.out_lo, first.lo - last.lo};
      bad |= may_exceed(path, length, ends);
      const LaneMask turns = ends.turn();
      if (any(turns)) {
        const DiscTurn turn = turn_on_disc(path, x, y, from, length, ends, End::kLower);
        bad |= turns & ~turn.found;
        lo = select(turns, lesser(turn.z, lo), lo);
      }
    }
    const LaneMask below = ~(first.covers | last.covers | block.loses_all_above(row));
    bad |= below & ~held_by_disc(path, magnitude(first.hi - last.hi), length);
    if ((known.hides_exit >> row & 1) == 0) {
      const DiscEnds ends{first.out_hi, last.out_hi, last.hi - first.hi};
      bad |= below & may_exceed(path, length, ends);
      const LaneMask turns = below & ends.turn();
      if (any(turns)) {
        const DiscTurn turn = turn_on_disc(path, x, y, from, length, ends, End::kUpper);
        bad |= turns & ~turn.found;
        hi = select(turns, greater(turn.z, hi), hi);
      }
    }
    if (any(bad)) return false;
    block.add(row, select(open, lo, none), select(open, hi, -none));
    first = last;
  }
  return true;
}

}  // namespace kerf
