// SPDX-License-Identifier: Apache-2.0
#include "server/verify/part_model.h"

#include <cmath>
#include <utility>

#include "kernel/dexel/dexel_tile.h"
#include "kernel/dexel/mesh_stock.h"

namespace kerf {
namespace {

constexpr double kRoundsPerMm = 1e4;

TriangleMesh in_scene(const IndexedMesh& mesh) {
  TriangleMesh made{{}, mesh.triangles};
  made.vertices_mm.reserve(mesh.positions_mm.size());
  for (std::uint32_t v = 0; v < mesh.positions_mm.size(); ++v)
    made.vertices_mm.push_back(mesh.origin_mm + mesh.position(v));
  return made;
}

Vec3 rounded(Vec3 p) {
  const auto round = [](double mm) { return std::round(mm * kRoundsPerMm) / kRoundsPerMm + 0; };
  return {round(p.x), round(p.y), round(p.z)};
}

// Tiles that `dexelize` omits are solid from the lowest plane of the grid to the highest.
DexelSnapshot material_of(const TriangleMesh& mesh, const DexelGrid& grid) {
  TileDirectory tiles(grid.tiles_x(), grid.tiles_y());
  dexelize(mesh, grid, false, [&](TileIndex at, std::shared_ptr<DexelTile> tile) {
    tiles.slot(at, 0) = std::move(tile);
  });
  const Vec3 size{grid.columns_x * grid.pitch_mm, grid.columns_y * grid.pitch_mm,
                  grid.height_quanta * grid.z_quantum_mm};
  const BoxStock box{grid.origin_mm, grid.origin_mm + size};
  return {grid, box, ColumnShares(box, grid), tiles, tiles};
}

}  // namespace

PartModel::PartModel(const IndexedMesh& mesh, const MeshDistance& surface, const DexelGrid& grid)
    : surface_(surface), grid_(grid) {
  const TriangleMesh solid = in_scene(mesh);
  fault_ = mesh_stock_fault(solid);
  if (fault_.empty()) material_ = material_of(solid, grid);
}

BoxStock bounds_of(const IndexedMesh& mesh) {
  const BoxStock box = mesh_bounds(in_scene(mesh));
  return {rounded(box.min_mm), rounded(box.max_mm)};
}

}  // namespace kerf
