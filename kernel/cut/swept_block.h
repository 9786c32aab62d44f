// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "kernel/dexel/dexel_grid.h"
#include "kernel/dexel/dexel_tile.h"
#include "kernel/sweep/swept_tool.h"

namespace kerf {

/// Moves `block` to the 8 x 8 columns whose first is (i, j), both multiples of eight, and fills it
/// with the intervals that `swept` removes from them, down to the lowest stock. `stored` is the
/// tile of these columns, or null if all of it may hold stock.
void sweep_block(const SweptTool& swept, const DexelGrid& grid, const DexelTile* stored,
                 std::int32_t i, std::int32_t j, ColumnBlock& block);

}  // namespace kerf
