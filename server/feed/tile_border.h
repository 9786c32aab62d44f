// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "kernel/dexel/dexel_grid.h"
#include "kernel/surface/tile_mesh.h"

namespace kerf {

/// Returns the mesh with its four borders (in the order of kSides) simplified to within
/// `side_error_mm`; 0 leaves a border unchanged. The result on a border depends only on the
/// vertices that both tiles have there, so both tiles get the same border.
TileMesh with_coarser_borders(const TileMesh& mesh, const DexelGrid& grid,
                              const std::array<double, 4>& side_error_mm);

/// Returns true if other triangles between the vertices of a tile's mesh, three `indices` each,
/// have the same open edges along the tile's borders as the mesh.
bool same_border(const TileMesh& mesh, std::span<const std::uint32_t> indices,
                 const DexelGrid& grid);

}  // namespace kerf
