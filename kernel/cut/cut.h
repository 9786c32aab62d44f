// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

#include "kernel/cut/lazy_normals.h"
#include "kernel/cut/reach.h"
#include "kernel/cut/removal.h"
#include "kernel/dexel/dexel_field.h"
#include "kernel/sweep/swept_tool.h"

namespace kerf {

/// Removes a swept tool from the field and stores the removed elements in `removal`, replacing its
/// previous contents. Performs the three updates of paper Fig. 1 (c–e): shortening an element at
/// its top or its bottom, or splitting it. Ends are rounded to the nearest depth quantum before
/// they are compared, so cuts commute to the bit. Columns that do not change are not written. The
/// ends that move get the stock's normals. Returns the number of tiles in the bounds of the sweep.
std::int64_t cut(DexelField& field, const SweptTool& swept, Removal& removal);

/// Removes one part of a tool's motion, for which `normals` will compute the normals. Only the run
/// `tiles` is cut.
std::int64_t cut(DexelField& field, LazyNormals& normals, const Tool& tool, const SubMotion& part,
                 Removal& removal, TileRun tiles);

/// As above, for these tiles of the grid only, in this order and without duplicates.
void cut_tiles(DexelField& field, LazyNormals& normals, const Tool& tool, const SubMotion& part,
               std::span<const TileIndex> tiles, Removal& removal);

}  // namespace kerf
