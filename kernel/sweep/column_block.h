// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <vector>

#include "kernel/math/lanes.h"
#include "kernel/math/tolerance.h"
#include "kernel/math/vec3.h"

namespace kerf {

/// Rows of columns that are evaluated at once: eight rows of a group of eight columns each.
inline constexpr int kBlockSide = kLanes;

/// A block of 8 x 8 columns, and the heights that a sweep removes from each: the unit of work. Most
/// columns lose one interval; what does not join it stands in `apart`.
struct ColumnBlock {
  struct Apart {
    int row;
    Lanes lo_mm, hi_mm;
  };

  Lanes x_mm;                ///< of the columns, the same in every row
  double y_mm[kBlockSide];   ///< of the rows
  unsigned rows = 0;         ///< bit r: row r is to be evaluated
  double join_mm = 0;        ///< intervals of a column that are no farther apart become one
  double top_mm = 0;         ///< no stock of the block reaches higher: ends above need no digits
  Lanes lo_mm[kBlockSide];   ///< out: lowest removed height; +inf where nothing is
  Lanes hi_mm[kBlockSide];   ///< out: highest removed height; −inf where nothing is
  std::vector<Apart> apart;  ///< out: further intervals; empty lanes have lo > hi

  Lanes lowest_mm;      ///< of each row: nothing that is evaluated reaches below
  unsigned filled = 0;  ///< bit r: row r holds intervals

  /// Empties all rows.
  void clear() {
    filled = 0;
    apart.clear();
  }

  /// Columns of a row that have not yet lost all that is above `lowest_mm`: the others have nothing
  /// to lose to what is evaluated.
  KERF_INLINE LaneMask open(int row) const {
    if ((filled >> row & 1) == 0) return every_lane();
    return (lo_mm[row] > lowest_mm[row]) | (hi_mm[row] < top_mm);
  }
  /// Takes rows without an open column out of `rows`.
  void leave_closed_rows();

  /// Adds the interval [lo, hi] (empty where lo > hi) to the columns of a row. Intervals that touch
  /// become one, so that no sliver stays where two pieces of a tool meet; those above the stock do
  /// not count.
  KERF_INLINE void add(int row, Lanes lo, Lanes hi) {
    const LaneMask adds = (lo <= hi) & (lo < top_mm);
    if ((filled >> row & 1) == 0) {
      const Lanes none = std::numeric_limits<double>::infinity();
      filled |= 1U << row;
      lo_mm[row] = select(adds, lo, none);
      hi_mm[row] = select(adds, hi, -none);
      return;
    }
    const Lanes present_lo = lo_mm[row], present_hi = hi_mm[row];
    const LaneMask joins = adds & ((present_lo > present_hi) |
                                   ((lo <= present_hi + join_mm) & (present_lo <= hi + join_mm)));
    lo_mm[row] = select(joins & (lo < present_lo), lo, present_lo);
    hi_mm[row] = select(joins & (hi > present_hi), hi, present_hi);
    const LaneMask stays_apart = adds & ~joins;
    if (any(stays_apart)) keep_apart(row, stays_apart, lo, hi);
  }

 private:
  void keep_apart(int row, const LaneMask& which, const Lanes& lo, const Lanes& hi);
};

/// Bit i is set where lane i of a is less than that of b.
unsigned lanes_below(const Lanes& a, const Lanes& b);

/// Limits of a swept piece (mm); nothing outside is removed.
struct SweepBounds {
  Vec3 min_mm, max_mm;
};

/// Eight discs of the XY plane, all of radius `reach_mm`: asked of a sweep to find out which parts
/// of the stock it can leave alone.
struct Discs {
  Lanes x_mm, y_mm;
  double reach_mm;
};

}  // namespace kerf
