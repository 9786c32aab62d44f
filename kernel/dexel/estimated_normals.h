// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernel/dexel/dexel_grid.h"
#include "kernel/dexel/stock_shape.h"
#include "kernel/dexel/tile_index.h"

namespace kerf {

struct DexelTile;

/// Estimates a normal for each end of a tile that has none and is not on the surface of the uncut
/// stock. It is the normal of the plane through the neighboring ends of the same kind, in this
/// tile, that are within four pitches of the end's depth. So stock with unknown normals is
/// displayed smoothly. At an edge, the error is up to that of using one side's normal. The tile
/// must keep normals.
void estimate_normals(DexelTile& tile, TileIndex at, const StockShape& stock,
                      const DexelGrid& grid);

}  // namespace kerf
