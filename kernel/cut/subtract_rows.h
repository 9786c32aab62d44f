// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernel/cut/removal.h"
#include "kernel/dexel/dexel_grid.h"
#include "kernel/sweep/column_block.h"

namespace kerf {

/// A view of the topmost elements of a block's columns in a tile, with flags for the columns that
/// have lower elements. Depths in quanta.
struct BlockElements {
  const std::int32_t *bottom, *top;  ///< of the first column
  const std::uint32_t* split;        ///< of the first row; bit `first_bit` is the first column's
  int first_bit;
  int stride;  ///< distance of rows in `bottom` and `top`
};

/// The result of subtracting a sweep from a block's topmost elements.
struct BlockChange {
  struct Row {
    alignas(32) std::int32_t bottom[kLanes], top[kLanes];  ///< the remaining element
  };
  struct LeftOver {
    int row;
    /// Bit c is set if column c has several elements, or the cut splits its only one.
    unsigned columns;
    alignas(32) std::int32_t cut_bottom[kLanes], cut_top[kLanes];
  };
  Row rows[kBlockSide];
  /// Bit r is set if row r must be replaced. Each such row has a group, in row order.
  unsigned changed;
  std::int64_t quanta;  ///< total length removed
  LeftOver left_over[kBlockSide];
  int left_overs;
};

/// Subtracts the heights [lo, hi] of a block (mm; lo > hi where nothing is removed) from the
/// topmost elements of the rows set in `rows` (paper Fig. 1 c, d), after rounding them to the
/// nearest depth quantum within the stock. Columns of several elements, and those that would be
/// split, are left to the caller in `change.left_over`. `groups`, with space for eight, receives
/// the removed elements. (first_i, first_j) is the block's first column.
void subtract_rows(const ColumnBlock& block, unsigned rows, const DexelGrid& grid,
                   const BlockElements& elements, std::int32_t first_i, std::int32_t first_j,
                   RemovedGroup* groups, BlockChange& change);

}  // namespace kerf
