// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>
#include <span>

#include "kernel/cut/removal.h"
#include "kernel/cut/workers.h"
#include "kernel/dexel/dexel_field.h"
#include "kernel/sweep/swept_tool.h"

namespace kerf {

/// A run of tiles, counted row by row in the rectangle of tiles that bounds a sweep.
struct TileRun {
  std::int64_t first = 0;
  std::int64_t count = std::numeric_limits<std::int64_t>::max() / 2;
};

/// Removes a swept tool from the field and stores in `removal` what was removed; its previous
/// contents are dropped. Performs the three updates of paper Fig. 1 (c–e): shortening an element at
/// its top or its bottom, or splitting it. Ends are rounded to the nearest depth quantum before
/// they are compared, so cuts commute to the bit. Columns that do not change are not written. Large
/// cuts are divided among `workers` by tiles. In a field that keeps normals, the ends that move are
/// marked with `end_code` (lazy_normals.h). Only the run `tiles` is cut. Returns the number of
/// tiles in the bounds of the sweep.
std::int64_t cut(DexelField& field, const SweptTool& swept, Removal& removal, Workers& workers,
                 NormalCode end_code = kStockNormal, TileRun tiles = {});

/// The same for these tiles of the grid only, in this order and without duplicates, on the calling
/// thread.
void cut_tiles(DexelField& field, const SweptTool& swept, std::span<const TileIndex> tiles,
               Removal& removal, NormalCode end_code = kStockNormal);

}  // namespace kerf
