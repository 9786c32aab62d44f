// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "kernel/surface/tile_mesh.h"

namespace kerf {

/// Cells along a side of a tile whose mesh may have vertices in them: one for each of its columns,
/// and the one before the first. The cells at both ends are shared with the neighbors.
inline constexpr int kCellsOfTile = kTileSide + 1;

/// The column of cells of a vertex, relative to the tile's first, 0 to kCellsOfTile - 1; {-1, -1}
/// for a cell outside the tile.
struct TileCell {
  int x = -1, y = -1;
  friend bool operator==(const TileCell&, const TileCell&) = default;
};

/// Returns the cell of a vertex along one axis: cell i is between columns i and i + 1.
std::int32_t cell_of(float mm, double pitch_mm);

/// Returns the cell of each vertex.
std::vector<TileCell> cells_of(const TileMesh& mesh, double pitch_mm);

}  // namespace kerf
