// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "kernel/dexel/dexel_grid.h"
#include "kernel/surface/tile_mesh.h"

namespace kerf {

/// The mesh of a tile whose four borders (in the order of kSides) are drawn with fewer vertices, at
/// most `side_error_mm` off; 0 leaves one as it is. What a border becomes depends on nothing but
/// the vertices that both tiles have on it, so both make the same of it.
TileMesh with_coarser_borders(const TileMesh& mesh, const DexelGrid& grid,
                              const std::array<double, 4>& side_error_mm);

/// Whether two meshes of one tile have the same open edges along its borders.
bool same_border(const TileMesh& a, const TileMesh& b, const DexelGrid& grid);

}  // namespace kerf
