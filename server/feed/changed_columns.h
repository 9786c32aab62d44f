// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "kernel/dexel/solid_snapshot.h"
#include "kernel/surface/tile_mesh.h"

namespace kerf {

/// Returns the differences of two states of one block within `tiles`: for each tile the smallest
/// rectangle of columns whose elements or normals differ; no entry for an unchanged tile. The whole
/// tile if only one of the states stores it, and in a block with three fields, whose other rays are
/// not compared.
std::vector<ChangedColumns> changed_columns(const SolidSnapshot& before, const SolidSnapshot& after,
                                            std::span<const TileIndex> tiles);

}  // namespace kerf
