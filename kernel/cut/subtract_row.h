#pragma once

#include "kernel/dexel/dexel_snapshot.h"
#include "kernel/math/lanes.h"

namespace kerf {

/// What a cut makes of the topmost elements of eight neighbouring columns; depths in quanta.
struct RowChange {
  alignas(32) std::int32_t cut_bottom[kLanes], cut_top[kLanes];  ///< what is to be removed
  alignas(32) std::int32_t bottom[kLanes], top[kLanes];          ///< what stays
  alignas(32) std::int32_t removed_bottom[kLanes], removed_top[kLanes];
  std::int64_t quanta;  ///< total length removed
  unsigned left_over;   ///< bit c: column c has several elements, or the cut divides its only one
};

/// Rounds the heights [lo, hi] (mm; lo > hi where nothing is removed) to the nearest depth quantum
/// within the block and subtracts them (paper Fig. 1 c, d) from the topmost elements of eight
/// columns, except those with a bit in `split` and those that would be divided.
void subtract_row(const Lanes& lo_mm, const Lanes& hi_mm, const DexelGrid& grid,
                  const std::int32_t* bottom, const std::int32_t* top, unsigned split,
                  RowChange& change);

}  // namespace kerf
