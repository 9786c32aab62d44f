// SPDX-License-Identifier: Apache-2.0
#include "server/feed/tile_detail.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "server/feed/quad_merge.h"
#include "server/feed/tile_border.h"

namespace kerf {
namespace {

constexpr std::array<double, kDetailLevelMax + 1> kErrorPitches{0, 0.125, 0.5, 2};
/// Greatest error of shading, as the difference of unit normals. Where level 3 is displayed the
/// pitch is a quarter of a pixel or less, so no shape of that size is visible.
constexpr std::array<double, kDetailLevelMax + 1> kTurns{0, 0.08, 0.12, 0.5};
/// Greatest error of a border. One this small turns little too, because its vertices are a pitch
/// apart. The normals themselves cannot be compared there, because the two tiles may have different
/// ones.
constexpr std::array<double, kDetailLevelMax + 1> kBorderErrorPitches{0, 0.03, 0.06, 0.5};
constexpr double kCoarserMargin = 1.25;

double outside(double value, double low, double high) {
  return std::max({low - value, value - high, 0.0});
}

/// Collapses edges inside a part of the tile. Its border is locked.
std::vector<std::uint32_t> simplified(const TileMesh& mesh, std::span<const std::uint32_t> part,
                                      double error_mm) {
  const float* const positions = mesh.positions_mm.front().data();
  constexpr std::size_t kStride = sizeof(mesh.positions_mm.front());
  const float scale = meshopt_simplifyScale(positions, mesh.positions_mm.size(), kStride);
  std::vector<std::uint32_t> indices(part.size());
  indices.resize(meshopt_simplify(
      indices.data(), part.data(), part.size(), positions, mesh.positions_mm.size(), kStride, 0,
      static_cast<float>(error_mm) / scale, meshopt_SimplifyLockBorder, nullptr));
  return indices;
}

/// Simplifies the inside of a tile, original and cut surface separately, so that the rim between
/// them stays. Neighbors rely on the border, so the result is discarded if the border changed.
TileMesh with_simpler_inside(TileMesh mesh, const DexelGrid& grid, double error_mm) {
  std::array<std::vector<std::uint32_t>, 2> plain;
  std::vector<std::uint32_t> indices;
  for (std::size_t t = 0; t < mesh.indices.size(); t += 3) {
    const auto corners = std::span(mesh.indices).subspan(t, 3);
    const std::size_t original = std::size_t{mesh.original[corners[0]]} +
                                 mesh.original[corners[1]] + mesh.original[corners[2]];
    std::vector<std::uint32_t>& to = original % 3 == 0 ? plain[original / 3] : indices;
    to.insert(to.end(), corners.begin(), corners.end());
  }
  for (const auto& part : plain) {
    if (part.empty()) continue;
    const std::vector<std::uint32_t> simpler = simplified(mesh, part, error_mm);
    indices.insert(indices.end(), simpler.begin(), simpler.end());
  }
  if (same_border(mesh, indices, grid)) mesh.indices = std::move(indices);
  return mesh;
}

/// Removes triangles with two corners at the same position (but different normals), and unused
/// vertices.
void compact(TileMesh& mesh) {
  const auto at = [&](std::size_t corner) { return mesh.positions_mm[mesh.indices[corner]]; };
  std::size_t end = 0;
  for (std::size_t t = 0; t < mesh.indices.size(); t += 3) {
    if (at(t) == at(t + 1) || at(t + 1) == at(t + 2) || at(t + 2) == at(t)) continue;
    for (std::size_t c = 0; c < 3; ++c) mesh.indices[end++] = mesh.indices[t + c];
  }
  mesh.indices.resize(end);
  constexpr std::uint32_t kUnused = ~std::uint32_t{0};
  std::vector<std::uint32_t> place(mesh.positions_mm.size(), kUnused);
  for (const std::uint32_t index : mesh.indices) place[index] = 0;
  std::uint32_t kept = 0;
  for (std::size_t v = 0; v < place.size(); ++v) {
    if (place[v] == kUnused) continue;
    mesh.positions_mm[kept] = mesh.positions_mm[v];
    mesh.normals[kept] = mesh.normals[v];
    mesh.original[kept] = mesh.original[v];
    place[v] = kept++;
  }
  mesh.positions_mm.resize(kept);
  mesh.normals.resize(kept);
  mesh.original.resize(kept);
  for (std::uint32_t& index : mesh.indices) index = place[index];
}

}  // namespace

double detail_error_mm(int level, double pitch_mm) {
  return kErrorPitches.at(static_cast<std::size_t>(level)) * pitch_mm;
}

TileMesh coarser_tile(const TileMesh& mesh, const DexelGrid& grid, const TileDetail& detail) {
  if (detail.level == 0 || mesh.indices.empty()) return mesh;
  std::array<double, 4> side_error_mm{};
  for (std::size_t n = 0; n < 4; ++n) {
    side_error_mm[n] = kBorderErrorPitches.at(detail.side[n]) * grid.pitch_mm;
  }
  const double error_mm = detail_error_mm(detail.level, grid.pitch_mm);
  TileMesh out = mesh;
  // The inside first, because slivers along simplified borders would block the collapses.
  out.indices = merged_quads(mesh, grid, {.error_mm = error_mm, .turn = kTurns.at(detail.level)});
  compact(out);
  out = with_coarser_borders(out, grid, side_error_mm);
  out = with_simpler_inside(std::move(out), grid, error_mm);
  compact(out);
  return out;
}

int detail_level(const ViewerLook& look, const DexelGrid& grid, TileIndex tile, int current) {
  const double side_mm = kTileSide * grid.pitch_mm;
  const Vec3 low = grid.origin_mm + Vec3{tile.x * side_mm, tile.y * side_mm, 0};
  const double height_mm = grid.height_quanta * grid.z_quantum_mm;
  const Vec3 off{outside(look.eye_mm.x, low.x, low.x + side_mm),
                 outside(look.eye_mm.y, low.y, low.y + side_mm),
                 outside(look.eye_mm.z, low.z, low.z + height_mm)};
  const double allowed_mm = look.error_rad * length(off);
  int level = 0;
  while (level < kDetailLevelMax) {
    const double margin = level + 1 > current ? kCoarserMargin : 1;
    if (detail_error_mm(level + 1, grid.pitch_mm) * margin > allowed_mm) break;
    ++level;
  }
  return level;
}

}  // namespace kerf
