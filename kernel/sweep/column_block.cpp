#include "kernel/sweep/column_block.h"

namespace kerf {
namespace {

KERF_INLINE unsigned find_rows_in_lanes(const ColumnBlock& block, const Lanes& lowest_mm) {
  unsigned rows = 0;
  for (int r = 0; r < kBlockSide; ++r) {
    if ((block.filled >> r & 1) == 0) continue;
    const LaneMask open = (block.lo_mm[r] > lowest_mm[r]) | (block.hi_mm[r] < block.top_mm);
    if (!any(open)) rows |= 1U << r;
  }
  return rows;
}
KERF_FOR_EACH_TARGET(unsigned, find_rows, (const ColumnBlock& block, const Lanes& lowest_mm),
                     (block, lowest_mm))

KERF_INLINE unsigned compare_in_lanes(const Lanes& a, const Lanes& b) { return bits(a < b); }
KERF_FOR_EACH_TARGET(unsigned, compare, (const Lanes& a, const Lanes& b), (a, b))

}  // namespace

unsigned lanes_below(const Lanes& a, const Lanes& b) { return compare(a, b); }

unsigned ColumnBlock::rows_beyond(const Lanes& lowest_mm) const {
  return filled == 0 ? 0 : find_rows(*this, lowest_mm);
}

void ColumnBlock::keep_apart(int row, const LaneMask& which, const Lanes& lo, const Lanes& hi) {
  const Lanes none = Lanes(std::numeric_limits<double>::infinity());
  apart.push_back({row, select(which, lo, none), select(which, hi, -none)});
}

}  // namespace kerf
