// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "kernel/cut/removal.h"
#include "kernel/dexel/dexel_grid.h"

namespace kerf {

/// Appends the tiles of the field along Z above and below what was removed from a field: those
/// whose surface looks different. A tile's side is as long in every field, so a tile of the field
/// along X spans one row of them, one of the field along Y one column. Those on the last border may
/// lie one beyond the grid.
void note_changed_tiles(const DexelGrid& grid, const Removal& removal,
                        std::vector<TileIndex>& changed);

}  // namespace kerf
