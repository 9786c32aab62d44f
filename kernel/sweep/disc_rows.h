// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <limits>
#include <vector>

#include "kernel/sweep/column_block.h"
#include "kernel/sweep/piece_side.h"
#include "kernel/sweep/slice_path.h"

// Most rays below a mill enter it through the lower disc, all along the motion. Then nothing has to
// be known of the side, and the end is that of a plane.

namespace kerf {

/// Eight rays and a slice at one pose. Heights are relative to the middle tip.
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
  const LaneMask enters = p2 + t0 * t0 - discs.low * discs.low < pose.low_radius2;
  m.lo = pose.center.z + t0;
  m.out_lo = -(speed + t0 * pose.by_place.z);
  const double t = top - pose.center.z;
  const Lanes l = along + t * pose.u.z;
  m.covers = (l >= discs.low) & (l <= discs.high) & side.holds(p2 + t * t - l * l, l);
  m.hi = Lanes(top);
  m.out_hi = Lanes(0);
  m.usable = enters & m.covers;
  if (!any(enters & ~m.covers)) return m;
  const Lanes t1 = (discs.high - along) * pose.inverse_uz;
  m.usable = enters & (m.covers | (p2 + t1 * t1 - discs.high * discs.high < pose.high_radius2));
  m.hi = select(m.covers, m.hi, pose.center.z + t1);
  m.out_hi = speed + t1 * pose.by_place.z;
  return m;
}

/// Returns the rays for which the end of a disc, at `from` with the speed `out_from` outwards, and
/// after the share `length` at `to` with `out_to`, may lie farther out in between by more than the
/// search may miss.
KERF_INLINE LaneMask may_exceed(const SlicePath& path, double length, Lanes beyond, Lanes out_from,
                                Lanes out_to) {
  LaneMask may = (out_from > 0.0) & (out_to < 0.0);
  const double covered = std::sqrt(2 * path.search.missed_mm / path.search.bend_mm);
  const double left = length - covered;
  if (!path.search.checked || !(left > 0)) return may;
  // `beyond` > 0: the last end is farther out. The bound is that of least_off, from the other one.
  const Lanes rise = magnitude(beyond);
  const Lanes advance = greater(select(beyond > 0.0, out_from, -out_to), Lanes(0));
  const Lanes fall = advance + path.frame.turn * rise + 0.5 * path.search.bend_mm * left;
  return may | ~(path.discs.least_uz * rise - fall * left >= -path.search.missed_mm);
}

/// Adds the intervals of the rays `open` of a row whose rays all enter the slice through its lower
/// disc and leave it through the upper one or above the grid: whether they do must not depend on
/// the stock, and the other formulas differ in the last bits. `known`: of all rows of the block.
/// Returns false if there are other rays, or an end has to be searched; the row may have got a part
/// of its intervals then.
template <class Side>
KERF_INLINE bool add_disc_row(const Side& side, const SlicePath& path, Lanes y, int row,
                              LaneMask open, const RowBits& known, ColumnBlock& block) {
  const Lanes x = block.x_mm - path.frame.tip.x, none = std::numeric_limits<double>::infinity();
  const double z = path.frame.tip.z, top = path.search.top_mm - z;
  const std::vector<DiscPose>& poses = path.discs.poses;
  if ((known.ahead >> row & 1) != 0) {
    const DiscMeeting m = meet_discs(side, poses.back(), x, y, top);
    if (any(~m.usable)) return false;
    block.add(row, select(open, m.lo + z, none), select(open, m.hi + z, -none));
    return true;
  }
  if (poses.size() == 1) return false;
  const double length = 1 / double(poses.size() - 1);
  DiscMeeting first = meet_discs(side, poses[0], x, y, top);
  if (any(~first.usable)) return false;
  for (std::size_t k = 1; k < poses.size(); ++k) {
    const DiscMeeting last = meet_discs(side, poses[k], x, y, top);
    LaneMask bad = ~last.usable | (first.lo > last.hi) | (last.lo > first.hi);
    if ((known.hides_entry >> row & 1) == 0) {
      bad |= may_exceed(path, length, first.lo - last.lo, first.out_lo, last.out_lo);
    }
    if ((known.hides_exit >> row & 1) == 0) {
      bad |= ~(first.covers | last.covers | block.loses_all_above(row)) &
             may_exceed(path, length, last.hi - first.hi, first.out_hi, last.out_hi);
    }
    if (any(bad)) return false;
    const Lanes lo = lesser(first.lo, last.lo), hi = greater(first.hi, last.hi);
    block.add(row, select(open, lo + z, none), select(open, hi + z, -none));
    first = last;
  }
  return true;
}

}  // namespace kerf
