// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "kernel/cut/removal.h"
#include "kernel/dexel/dexel_grid.h"
#include "kernel/sweep/ball_sweep.h"
#include "kernel/sweep/column_block.h"

namespace kerf {

/// The only elements of a block's columns, in a tile that may be edited. Rows are kTileSide apart.
/// Depths in quanta.
struct SingleElements {
  std::int32_t *bottom, *top;  ///< of the first column
};

/// The result of lower_tops.
struct LoweredTops {
  int groups = 0;            ///< rows that changed, each with a group of removed elements
  std::int64_t quanta = 0;   ///< total length removed
  std::int32_t highest = 0;  ///< top of the block's columns, at least 0
};

/// Removes everything above the lower ends of a ball that stays above the stock from the rows set
/// in `rows` of a block without split columns: computes the ends, rounds them to the nearest depth
/// quantum, and shortens the elements, in one pass. The result equals that of BallSweep::evaluate
/// and subtract_rows. (first_i, first_j) is the block's first column. `groups`, with space for
/// eight, receives the removed elements in row order.
LoweredTops lower_tops(const BallSweep& ball, const ColumnBlock& block, unsigned rows,
                       const DexelGrid& grid, const SingleElements& elements, std::int32_t first_i,
                       std::int32_t first_j, RemovedGroup* groups);

}  // namespace kerf
