// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "kernel/dexel/dexel_grid.h"
#include "kernel/dexel/stock_shape.h"
#include "kernel/dexel/tile_index.h"

namespace kerf {

struct DexelTile;

/// Intersects the columns of `tile` with those of `other`, the same tile of another copy of the
/// block, with normals if `tile` has them. Each end keeps the normal of the tile that it comes
/// from. If both have an end at the same depth, it keeps the normal of `tile`.
void keep_common(DexelTile& tile, const DexelTile& other);

/// Subtracts `other` from `tile`. New ends get the normals that `other` has there.
void remove_common(DexelTile& tile, const DexelTile& other);

/// Adds the elements of `other` to `tile`, with normals if `tile` has them. Elements that touch are
/// joined. If both have an end at the same depth, it keeps the normal of `tile`.
void add_solid(DexelTile& tile, const DexelTile& other);

/// Returns boxes, in the frame of the grid, around the rays and elements of each non-empty block of
/// 8 x 8 columns. Returns no box if the tile is empty.
std::vector<BoxStock> solid_boxes(const DexelTile& tile, TileIndex at, const DexelGrid& grid);

}  // namespace kerf
