// SPDX-License-Identifier: Apache-2.0
#include "server/formats/model/mesh_source.h"

#include <utility>

#include "kernel/surface/tile_mesh.h"

namespace kerf {
namespace {

/// Pieces per thread that are meshed at once: some milliseconds of work.
constexpr std::size_t kPiecesAhead = 8;

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
  if (read_ == ahead_.size()) mesh_ahead();
  if (ahead_.empty()) return false;
  TileMesh& mesh = ahead_[read_++];
  piece.positions_mm = std::move(mesh.positions_mm);
  piece.normals = std::move(mesh.normals);
  piece.indices = std::move(mesh.indices);
  piece.colors.clear();
  piece.deviations_mm.clear();
  return true;
}

void SnapshotMesh::mesh_ahead() {
  ahead_.clear();
  read_ = 0;
  const int threads = workers_ == nullptr ? 1 : workers_->count();
  const std::size_t wanted = threads == 1 ? 1 : static_cast<std::size_t>(threads) * kPiecesAhead;
  TileMesh mesh;
  while (ahead_.size() < wanted && begin(mesh)) ahead_.push_back(std::move(mesh));
  const auto job = [this](int n) { finish(ahead_[static_cast<std::size_t>(n)]); };
  const auto jobs = static_cast<int>(ahead_.size());
  workers_ == nullptr ? SerialWorkers().run(jobs, job) : workers_->run(jobs, job);
}

bool SnapshotMesh::begin(TileMesh& mesh) {
  if (faces_ == FlatFaces::kMerged) {
    if (!merged_) merged_ = std::make_unique<SolidSurface>(snapshot_);
    return merged_->begin(mesh);
  }
  const DexelGrid& grid = snapshot_.grid();
  if (next_tile_ == tile_count(grid)) return false;
  mesh.tile = {static_cast<std::int32_t>(next_tile_ % grid.tiles_x()),
               static_cast<std::int32_t>(next_tile_ / grid.tiles_x())};
  ++next_tile_;
  return true;
}

void SnapshotMesh::finish(TileMesh& mesh) const {
  if (merged_) {
    merged_->finish(mesh);
  } else {
    mesh = mesh_tile(snapshot_, mesh.tile);
  }
}

double SnapshotMesh::share() const {
  if (faces_ == FlatFaces::kMerged) return merged_ ? merged_->share() : 0;
  return static_cast<double>(next_tile_) / static_cast<double>(tile_count(snapshot_.grid()));
}

}  // namespace kerf
