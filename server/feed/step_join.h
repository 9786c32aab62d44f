// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "kernel/surface/tile_mesh.h"
#include "server/feed/tile_cells.h"

namespace kerf {

/// Joins the vertices that a smooth surface has in a column of cells, one in each layer that it
/// passes. The quadrangles between them vanish, so the surface becomes a height field with a
/// quadrangle for each column of the lattice. Returns the indices of the remaining triangles, three
/// each. A dropped vertex was at most twice `error_mm` from them. Vertices at creases and in the
/// cells that the tile shares with its neighbors stay. `cells`: of the mesh's vertices.
std::vector<std::uint32_t> joined_steps(const TileMesh& mesh, std::span<const TileCell> cells,
                                        double pitch_mm, float error_mm);

}  // namespace kerf
