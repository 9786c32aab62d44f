// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "kernel/dexel/solid_snapshot.h"
#include "kernel/math/ray_axis.h"
#include "kernel/piece/bounds.h"

namespace kerf {

/// A quantum of a column of a field: from `depth` to depth + 1.
struct StockCell {
  RayAxis axis = RayAxis::kZ;
  std::int32_t i = 0, j = 0;  ///< column, within the grid
  std::int32_t depth = 0;
};

/// Returns whether a quantum was stock before the block's first motion, in the state `start`.
bool was_stock(const SolidSnapshot& start, const StockCell& cell);
/// Returns a box around the ray of a quantum, enlarged by a margin, in world coordinates, mm.
Bounds box_of(const StockCell& cell, const DexelGrid& grid, double margin_mm);

}  // namespace kerf
