// SPDX-License-Identifier: Apache-2.0
#include "server/formats/model/mesh_source.h"

#include <utility>

#include "kernel/surface/tile_mesh.h"

namespace kerf {
namespace {

std::int64_t tile_count(const DexelGrid& grid) {
  return std::int64_t{grid.tiles_x()} * grid.tiles_y();
}

}  // namespace

Vec3 SnapshotMesh::size_mm() const {
  const DexelGrid& grid = snapshot_.grid();
  return {grid.columns_x * grid.pitch_mm, grid.columns_y * grid.pitch_mm,
          grid.height_quanta * grid.z_quantum_mm};
}

bool SnapshotMesh::next(MeshPiece& piece) {
  const DexelGrid& grid = snapshot_.grid();
  if (next_tile_ == tile_count(grid)) return false;
  const TileIndex tile{static_cast<std::int32_t>(next_tile_ % grid.tiles_x()),
                       static_cast<std::int32_t>(next_tile_ / grid.tiles_x())};
  ++next_tile_;
  TileMesh mesh = mesh_tile(snapshot_, tile);
  piece.positions_mm = std::move(mesh.positions_mm);
  piece.normals = std::move(mesh.normals);
  piece.indices = std::move(mesh.indices);
  piece.colors.clear();
  piece.deviations_mm.clear();
  return true;
}

double SnapshotMesh::share() const {
  return static_cast<double>(next_tile_) / static_cast<double>(tile_count(snapshot_.grid()));
}

}  // namespace kerf
