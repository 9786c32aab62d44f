// SPDX-License-Identifier: Apache-2.0
#include "server/feed/tile_cells.h"

#include <cmath>

namespace kerf {

std::int32_t cell_of(float mm, double pitch_mm) {
  return static_cast<std::int32_t>(std::floor(static_cast<double>(mm) / pitch_mm - 0.5));
}

std::vector<TileCell> cells_of(const TileMesh& mesh, double pitch_mm) {
  std::vector<TileCell> cells;
  cells.reserve(mesh.positions_mm.size());
  const std::int32_t first_x = mesh.tile.x * kTileSide - 1, first_y = mesh.tile.y * kTileSide - 1;
  for (const auto& position : mesh.positions_mm) {
    const TileCell cell{cell_of(position[0], pitch_mm) - first_x,
                        cell_of(position[1], pitch_mm) - first_y};
    const bool inside =
        cell.x >= 0 && cell.y >= 0 && cell.x < kCellsOfTile && cell.y < kCellsOfTile;
    cells.push_back(inside ? cell : TileCell{});
  }
  return cells;
}

}  // namespace kerf
