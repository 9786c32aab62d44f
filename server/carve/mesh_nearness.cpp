// SPDX-License-Identifier: Apache-2.0
#include "server/carve/mesh_nearness.h"

#include <array>
#include <limits>
#include <utility>

#include "kernel/math/nearest_on_triangle.h"
#include "kernel/surface/tile_mesh.h"

namespace kerf {
namespace {

/// Meshed tiles in memory, about 0.3 MB each.
constexpr std::size_t kKeptMax = 600;
/// A tile gets few queries, so building the tree must be cheap.
constexpr std::uint32_t kTrianglesPerRun = 24;
/// Pitches by which a tile's mesh may extend beyond its columns.
constexpr double kOverhangPitches = 2;

std::vector<Box> tile_boxes(const DexelGrid& grid) {
  const double side = kTileSide * grid.pitch_mm, more = kOverhangPitches * grid.pitch_mm;
  const double height = grid.height_quanta * grid.z_quantum_mm;
  std::vector<Box> boxes;
  for (std::int32_t y = 0; y < grid.tiles_y(); ++y) {
    for (std::int32_t x = 0; x < grid.tiles_x(); ++x) {
      const Vec3 low = grid.origin_mm + Vec3{x * side, y * side, 0};
      boxes.push_back(
          {low - Vec3{more, more, more}, low + Vec3{side, side, height} + Vec3{more, more, more}});
    }
  }
  return boxes;
}

}  // namespace

MeshNearness::MeshNearness(const SolidSnapshot& snapshot)
    : snapshot_(snapshot), tiles_(tile_boxes(snapshot.grid())) {}

const MeshNearness::Tile& MeshNearness::tile(std::uint32_t index) {
  if (const auto found = meshed_.find(index); found != meshed_.end()) return found->second;
  if (oldest_first_.size() == kKeptMax) {
    meshed_.erase(oldest_first_.front());
    oldest_first_.pop_front();
  }
  oldest_first_.push_back(index);
  const DexelGrid& grid = snapshot_.grid();
  const auto columns = static_cast<std::uint32_t>(grid.tiles_x());
  const TileMesh mesh = mesh_tile(snapshot_, {static_cast<std::int32_t>(index % columns),
                                              static_cast<std::int32_t>(index / columns)});
  Tile made;
  std::vector<Box> boxes;
  const auto corner = [&](std::size_t n) {
    const auto& p = mesh.positions_mm[mesh.indices[n]];
    return grid.origin_mm + Vec3{double(p[0]), double(p[1]), double(p[2])};
  };
  for (std::size_t n = 0; n + 2 < mesh.indices.size(); n += 3) {
    const Triangle t{corner(n), corner(n + 1), corner(n + 2)};
    made.triangles.push_back(t);
    boxes.push_back(around(around({t[0], t[0]}, {t[1], t[1]}), {t[2], t[2]}));
  }
  made.tree = BoxTree(std::move(boxes), kTrianglesPerRun);
  return meshed_.emplace(index, std::move(made)).first->second;
}

double MeshNearness::distance_mm(Vec3 point) {
  double best = std::numeric_limits<double>::infinity();
  tiles_.visit_nearest(point, best, [&](std::uint32_t n) {
    const Tile& near = tile(n);
    // A triangle whose box contains the point still has a distance.
    near.tree.visit_nearest(point, best, [&](std::uint32_t t) {
      best = std::min(best, length(nearest_on_triangle(near.triangles[t], point).point - point));
    });
  });
  return best;
}

}  // namespace kerf
