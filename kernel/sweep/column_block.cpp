#include "kernel/sweep/column_block.h"

namespace kerf {

void ColumnBlock::clear() {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (int r = 0; r < kBlockSide; ++r) {
    lo_mm[r] = splat(kInfinity);
    hi_mm[r] = splat(-kInfinity);
  }
  apart.clear();
}

void ColumnBlock::keep_apart(int row, const LaneMask& which, const Lanes& lo, const Lanes& hi) {
  const Lanes none = splat(std::numeric_limits<double>::infinity());
  apart.push_back({row, select(which, lo, none), select(which, hi, -none)});
}

}  // namespace kerf
