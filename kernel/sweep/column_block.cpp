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

void ColumnBlock::keep_apart(int row, const LaneMask& which, const Lanes& lo, const Lanes& hi) {
  const Lanes none = Lanes(std::numeric_limits<double>::infinity());
  apart.push_back({row, select(which, lo, none), select(which, hi, -none)});
}

}  // namespace kerf
