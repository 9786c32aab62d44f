// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernel/dexel/dexel_grid.h"
#include "kernel/dexel/stock_shape.h"
#include "kernel/dexel/tile_index.h"

namespace kerf {

struct DexelTile;

/// Gives a normal to each end in a tile that has none and is not on the surface of the uncut stock:
/// that of the plane through the ends of the same kind in the columns beside it, in this tile, that
/// lie within four pitches of its depth. Stock whose normals are not known is displayed smoothly
/// so; at edges the normals are up to those of one side off. The tile must keep normals.
void estimate_normals(DexelTile& tile, TileIndex at, const StockShape& stock,
                      const DexelGrid& grid);

}  // namespace kerf
