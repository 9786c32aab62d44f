// SPDX-License-Identifier: Apache-2.0
#include "kernel/sweep/column_block.h"

namespace kerf {
namespace {

KERF_INLINE unsigned open_rows_in_lanes(const ColumnBlock& block) {
  unsigned rows = block.rows;
  for (int r = 0; r < kBlockSide; ++r) {
    if ((rows >> r & 1) != 0 && !any(block.open(r))) rows &= ~(1U << r);
  }
  return rows;
}
KERF_FOR_EACH_TARGET(unsigned, open_rows, (const ColumnBlock& block), (block))

KERF_INLINE unsigned compare_in_lanes(const Lanes& a, const Lanes& b) { return bits(a < b); }
KERF_FOR_EACH_TARGET(unsigned, compare, (const Lanes& a, const Lanes& b), (a, b))

}  // namespace

unsigned lanes_below(const Lanes& a, const Lanes& b) { return compare(a, b); }

void ColumnBlock::drop_closed_rows() {
  if (filled != 0) rows = open_rows(*this);
}

/// Adds an interval to a row that has intervals apart. It absorbs each interval that it joins, and
/// then becomes the row's interval or is kept apart.
void ColumnBlock::add_among(int row, const LaneMask& adds, const Lanes& lo, const Lanes& hi) {
  const Lanes none = Lanes(std::numeric_limits<double>::infinity());
  Lanes joined_lo = lo, joined_hi = hi;
  const auto take = [&](Lanes& other_lo, Lanes& other_hi) {
    const LaneMask joins =
        adds & (other_lo <= other_hi) & (lo <= other_hi + join_mm) & (other_lo <= hi + join_mm);
    joined_lo = select(joins, lesser(other_lo, joined_lo), joined_lo);
    joined_hi = select(joins, greater(other_hi, joined_hi), joined_hi);
    other_lo = select(joins, none, other_lo);
    other_hi = select(joins, -none, other_hi);
  };
  take(lo_mm[row], hi_mm[row]);
  for (Apart& a : apart) {
    if (a.row == row) take(a.lo_mm, a.hi_mm);
  }
  const LaneMask fits = adds & (lo_mm[row] > hi_mm[row]);
  lo_mm[row] = select(fits, joined_lo, lo_mm[row]);
  hi_mm[row] = select(fits, joined_hi, hi_mm[row]);
  const LaneMask stays_apart = adds & ~fits;
  if (any(stays_apart)) keep_apart(row, stays_apart, joined_lo, joined_hi);
}

/// Keeps an interval apart, in entries of the row that are empty, if there are any. So there are no
/// more entries than the number of intervals apart in one column at a time, times the columns.
void ColumnBlock::keep_apart(int row, const LaneMask& which, const Lanes& lo, const Lanes& hi) {
  for (Apart& a : apart) {
    if (a.row != row || any(which & (a.lo_mm <= a.hi_mm))) continue;
    a.lo_mm = select(which, lo, a.lo_mm);
    a.hi_mm = select(which, hi, a.hi_mm);
    return;
  }
  const Lanes none = Lanes(std::numeric_limits<double>::infinity());
  apart.push_back({row, select(which, lo, none), select(which, hi, -none)});
}

}  // namespace kerf
