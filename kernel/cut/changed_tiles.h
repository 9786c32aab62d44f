// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "kernel/cut/removal.h"
#include "kernel/dexel/dexel_grid.h"

namespace kerf {

/// The depths between which elements were removed, in quanta. top == 0 if none were.
struct RemovedDepths {
  std::int32_t bottom = 0, top = 0;
};
RemovedDepths depths_of(std::span<const RemovedGroup> removed);

/// Appends the tiles of the field along Z whose surface changes when elements between two depths
/// are removed from a tile of a field. A tile's side has the same length in every field, so a tile
/// of the field along X spans one row of tiles of the field along Z, and a tile of the field along
/// Y one column. May contain duplicates, and tiles one beyond the grid's last row or column.
void append_changed_tiles(const DexelGrid& grid, TileIndex tile, const RemovedDepths& depths,
                          std::vector<TileIndex>& changed);

}  // namespace kerf
