// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernel/dexel/dexel_grid.h"
#include "kernel/dexel/dexel_tile.h"
#include "kernel/dexel/tile_index.h"
#include "kernel/sweep/column_block.h"

namespace kerf {

// Positions of tiles, blocks and rows of columns, eight at a time: discs of the plane that enclose
// their columns. For each disc, `reached_below` (mm) is the height below which a sweep must reach
// to change any stock there, almost half a depth quantum below the stock's top.

/// Computes eight neighboring tiles of a row. `first` is the one with the least x.
void place_tiles(const DexelGrid& grid, TileIndex first, Discs& discs, Lanes& reached_below);

/// Computes the first (`half` 0) or second (1) half of a tile's 16 blocks. `tops` has upper bounds
/// of the stock in each block of the tile, in quanta (DexelTile::block_top), or is null if the tile
/// is untouched.
void place_blocks(const DexelGrid& grid, TileIndex tile, int half, const std::int32_t* tops,
                  Discs& discs, Lanes& reached_below);

/// Computes the eight rows of the block whose first column is (i, j), and sets the positions of its
/// columns in `block`. `tops` has the tops of its columns, rows kTileSide apart, or is null if the
/// tile is untouched.
void place_rows(const DexelGrid& grid, std::int32_t i, std::int32_t j, const std::int32_t* tops,
                ColumnBlock& block, Discs& discs, Lanes& reached_below);

/// Sets in `block` the height ranges of the stock in the columns of `rows` (bit r: row r). `column`
/// is the block's first column in the tile. `tile` is null if it is untouched.
void place_stock(const DexelGrid& grid, const DexelTile* tile, int column, unsigned rows,
                 ColumnBlock& block);

}  // namespace kerf
