// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "kernel/dexel/dexel_grid.h"
#include "kernel/dexel/dexel_tile.h"
#include "kernel/sweep/swept_tool.h"

namespace kerf {

/// Moves `block` to the 8 x 8 columns whose first is (i, j), both multiples of eight, and computes
/// the bounds of the pieces of `swept` there. Returns the rows (bit r: row r) that may change.
/// `stored` is the tile of these columns, or null if all of it may hold stock.
unsigned bound_block(const SweptTool& swept, const DexelGrid& grid, const DexelTile* stored,
                     std::int32_t i, std::int32_t j, ColumnBlock& block);

/// Returns the ball that alone changes `rows` of a block for which bound_block has been called, if
/// it stays above the block's stock, or null.
const BallSweep* ball_above(const SweptTool& swept, const ColumnBlock& block, unsigned rows);

/// Fills `rows` of a block for which bound_block has been called with the intervals that `swept`
/// removes, down to the lowest stock.
void sweep_rows(const SweptTool& swept, const DexelGrid& grid, const DexelTile* stored,
                std::int32_t i, std::int32_t j, unsigned rows, ColumnBlock& block);

/// bound_block and sweep_rows.
void sweep_block(const SweptTool& swept, const DexelGrid& grid, const DexelTile* stored,
                 std::int32_t i, std::int32_t j, ColumnBlock& block);

}  // namespace kerf
