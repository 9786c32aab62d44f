#pragma once

#include "kernel/cut/removal.h"
#include "kernel/dexel/dexel_snapshot.h"
#include "kernel/math/lanes.h"

namespace kerf {

/// The depths to be removed from eight neighbouring columns, in quanta; bottom >= top: nothing.
struct CutRow {
  alignas(32) std::int32_t bottom[kLanes], top[kLanes];
};

/// Rounds heights (mm; lo > hi where nothing is removed) to the nearest depth quantum within the
/// block.
void quantize(const Lanes& lo_mm, const Lanes& hi_mm, const DexelGrid& grid, CutRow& cut);

bool is_empty(const CutRow& cut);

/// What a cut makes of the topmost elements of eight columns.
struct RowChange {
  alignas(32) std::int32_t bottom[kLanes], top[kLanes];
  alignas(32) std::int32_t removed_bottom[kLanes], removed_top[kLanes];
  std::int64_t quanta;  ///< total length removed
  unsigned left_over;   ///< bit c: column c has several elements, or the cut divides its only one
};

/// Subtracts `cut` from the topmost elements (paper Fig. 1 c, d) of eight columns, except those
/// with a bit in `split` and those that would be divided.
void subtract_row(const CutRow& cut, const std::int32_t* bottom, const std::int32_t* top,
                  unsigned split, RowChange& change);

}  // namespace kerf
