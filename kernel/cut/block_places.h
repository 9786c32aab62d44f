// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernel/dexel/dexel_grid.h"
#include "kernel/dexel/tile_index.h"
#include "kernel/sweep/column_block.h"

namespace kerf {

// Where tiles, blocks and rows of columns are, eight at a time: discs that hold their columns, and
// for each the height that a sweep must come below to change any stock there (one depth quantum
// above the top of it).

/// Eight neighbouring tiles of a row, `first` the one with the least x.
void place_tiles(const DexelGrid& grid, TileIndex first, Discs& discs, Lanes& reached_below);

/// The first (0) or second (1) half of a tile's blocks. `tops`: no stock of a block is higher, for
/// all blocks of the tile; null where it is untouched.
void place_blocks(const DexelGrid& grid, TileIndex tile, int half, const std::int32_t* tops,
                  Discs& discs, Lanes& reached_below);

/// The eight rows of the block whose first column is (i, j), and the places of its columns. `tops`:
/// of its columns, rows kTileSide apart; null where the tile is untouched.
void place_rows(const DexelGrid& grid, std::int32_t i, std::int32_t j, const std::int32_t* tops,
                ColumnBlock& block, Discs& discs, Lanes& reached_below);

}  // namespace kerf
