// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "kernel/dexel/solid_snapshot.h"
#include "kernel/surface/tile_mesh.h"

namespace kerf {

/// Returns where two states of one block differ within `tiles`: for each tile the least rectangle
/// of its columns that contains all whose elements or normals differ, and nothing for a tile
/// without any. All of a tile if only one of the states stores it, and in a block with three
/// fields, whose other rays are not compared.
std::vector<ChangedColumns> changed_columns(const SolidSnapshot& before, const SolidSnapshot& after,
                                            std::span<const TileIndex> tiles);

}  // namespace kerf
