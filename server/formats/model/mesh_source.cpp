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
  TileMesh mesh;
  if (!next_mesh(mesh)) return false;
  piece.positions_mm = std::move(mesh.positions_mm);
  piece.normals = std::move(mesh.normals);
  piece.indices = std::move(mesh.indices);
  piece.colors.clear();
  piece.deviations_mm.clear();
  return true;
}

bool SnapshotMesh::next_mesh(TileMesh& mesh) {
  if (faces_ == FlatFaces::kMerged) {
    if (!merged_) merged_ = std::make_unique<SolidSurface>(snapshot_);
    return merged_->next(mesh);
  }
  const DexelGrid& grid = snapshot_.grid();
  if (next_tile_ == tile_count(grid)) return false;
  mesh = mesh_tile(snapshot_, {static_cast<std::int32_t>(next_tile_ % grid.tiles_x()),
                               static_cast<std::int32_t>(next_tile_ / grid.tiles_x())});
  ++next_tile_;
  return true;
}

double SnapshotMesh::share() const {
  if (faces_ == FlatFaces::kMerged) return merged_ ? merged_->share() : 0;
  return static_cast<double>(next_tile_) / static_cast<double>(tile_count(snapshot_.grid()));
}

}  // namespace kerf
