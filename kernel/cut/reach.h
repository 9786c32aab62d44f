// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "kernel/dexel/dexel_grid.h"
#include "kernel/dexel/dexel_tile.h"
#include "kernel/sweep/swept_tool.h"

namespace kerf {

/// A run of tiles, counted row by row in the rectangle of tiles that bounds a sweep.
struct TileRun {
  std::int64_t first = 0;
  std::int64_t count = std::numeric_limits<std::int64_t>::max() / 2;
};

/// Numbers of tiles, and of blocks of 8 x 8 columns, in the bounds of a sweep.
struct ReachSize {
  std::int64_t tiles = 0, blocks = 0;
};

/// Appends the tiles of a run that a sweep may change, row by row, regardless of the remaining
/// stock.
ReachSize find_tiles(const DexelGrid& grid, const SweptTool& swept, const TileRun& run,
                     std::vector<TileIndex>& tiles);

/// Returns the blocks of a tile that a sweep may change: bit b is set if it reaches below the top
/// of block b. `stored` is null if the tile is untouched.
unsigned find_blocks(const DexelGrid& grid, const SweptTool& swept, TileIndex tile,
                     const DexelTile* stored);

}  // namespace kerf
