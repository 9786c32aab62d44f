// SPDX-License-Identifier: Apache-2.0
#include "server/carve/surface_error.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "kernel/surface/tile_mesh.h"
#include "server/carve/mesh_nearness.h"

namespace kerf {
namespace {

// Meshing a tile costs more than measuring its samples.
constexpr std::size_t kTilesMax = 400;

std::vector<TileIndex> touched_tiles(const SolidSnapshot& snapshot) {
  std::vector<TileIndex> tiles;
  for (std::int32_t y = 0; y < snapshot.grid().tiles_y(); ++y)
    for (std::int32_t x = 0; x < snapshot.grid().tiles_x(); ++x)
      if (snapshot.touched({x, y})) tiles.push_back({x, y});
  return tiles;
}

// Corners, then centroids, in scene coordinates.
std::vector<Vec3> points_of(const TileMesh& mesh, Vec3 origin_mm) {
  std::vector<Vec3> points;
  points.reserve(mesh.positions_mm.size() + mesh.indices.size() / 3);
  for (const auto& p : mesh.positions_mm)
    points.push_back(origin_mm + Vec3{double(p[0]), double(p[1]), double(p[2])});
  for (std::size_t n = 0; n + 2 < mesh.indices.size(); n += 3)
    points.push_back(
        (points[mesh.indices[n]] + points[mesh.indices[n + 1]] + points[mesh.indices[n + 2]]) *
        (1.0 / 3));
  return points;
}

}  // namespace

DistanceFigures measure_surface(const SolidSnapshot& snapshot, const TrueSolid& truth,
                                std::size_t samples, const std::stop_token& stop) {
  const std::vector<TileIndex> tiles = touched_tiles(snapshot);
  const std::size_t meshed = std::min(tiles.size(), kTilesMax);
  std::vector<Vec3> points;
  for (std::size_t n = 0; n < meshed && !stop.stop_requested(); ++n) {
    const auto more =
        points_of(mesh_tile(snapshot, tiles[n * tiles.size() / meshed]), snapshot.grid().origin_mm);
    points.insert(points.end(), more.begin(), more.end());
  }
  std::vector<DistanceSample> errors;
  const std::size_t taken = std::min(points.size(), samples);
  for (std::size_t n = 0; n < taken && !stop.stop_requested(); ++n) {
    const auto [mm, cut] = truth.distance(points[n * points.size() / taken], stop);
    if (!cut) continue;
    errors.push_back({mm});
  }
  return distance_figures(std::move(errors));
}

DistanceFigures measure_missing(const SolidSnapshot& snapshot, const CutSurface& surface,
                                const std::stop_token& stop) {
  // Tile by tile, so that few tiles are meshed at a time.
  const DexelGrid& grid = snapshot.grid();
  const double side_mm = kTileSide * grid.pitch_mm;
  const auto tile_of = [&](const CutPoint& point) {
    const Vec3 p = point.mm - grid.origin_mm;
    return std::pair(std::floor(p.y / side_mm), std::floor(p.x / side_mm));
  };
  std::vector<CutPoint> points = surface.points;
  std::ranges::stable_sort(points, {}, tile_of);
  MeshNearness mesh(snapshot);
  std::vector<DistanceSample> errors;
  for (const CutPoint& point : points) {
    if (stop.stop_requested()) break;
    errors.push_back({mesh.distance_mm(point.mm)});
  }
  return distance_figures(std::move(errors));
}

}  // namespace kerf
