// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "kernel/cut/removal.h"
#include "kernel/dexel/dexel_grid.h"

namespace kerf {

/// Appends the tiles of the field along Z whose surface changes when `removal` is taken from a
/// field. A tile's side has the same length in every field, so a tile of the field along X spans
/// one row of tiles of the field along Z, and a tile of the field along Y one column. May contain
/// duplicates, and tiles one beyond the grid's last row or column.
void append_changed_tiles(const DexelGrid& grid, const Removal& removal,
                          std::vector<TileIndex>& changed);

}  // namespace kerf
