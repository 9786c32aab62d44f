// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernel/cut/removal.h"
#include "kernel/dexel/dexel_grid.h"
#include "kernel/sweep/column_block.h"

namespace kerf {

/// The topmost elements of a block's columns, as a tile holds them, and which columns have others
/// below. Depths in quanta.
struct BlockElements {
  const std::int32_t *bottom, *top;  ///< of the first column
  const std::uint32_t* split;        ///< of the first row; bit `first_bit` is the first column's
  int first_bit;
  int stride;  ///< from one row to the next in `bottom` and `top`
};

/// What a cut makes of them.
struct BlockChange {
  struct Row {
    alignas(32) std::int32_t bottom[kLanes], top[kLanes];  ///< what stays
  };
  struct LeftOver {
    int row;
    unsigned columns;  ///< bit c: column c has several elements, or the cut divides its only one
    alignas(32) std::int32_t cut_bottom[kLanes], cut_top[kLanes];
  };
  Row rows[kBlockSide];
  unsigned changed;     ///< bit r: row r is to be replaced; each has a group, in their order
  std::int64_t quanta;  ///< total length removed
  LeftOver left_over[kBlockSide];
  int left_overs;
};

/// Rounds the heights [lo, hi] (mm; lo > hi where nothing is removed) of some rows of a block to
/// the nearest depth quantum within the stock and subtracts them (paper Fig. 1 c, d) from the
/// topmost elements, except in columns of several elements and in those that would be divided. What
/// was taken goes to `groups`, which has room for eight; (first_i, first_j) is the block's first
/// column.
void subtract_rows(const ColumnBlock& block, unsigned rows, const DexelGrid& grid,
                   const BlockElements& elements, std::int32_t first_i, std::int32_t first_j,
                   RemovedGroup* groups, BlockChange& change);

}  // namespace kerf
