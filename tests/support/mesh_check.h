// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "kernel/surface/tile_mesh.h"

namespace kerf::test {

inline std::vector<TileMesh> mesh_all(const SolidSnapshot& solid) {
  std::vector<TileMesh> meshes;
  const DexelGrid& grid = solid.fields.front().grid();
  for (std::int32_t y = 0; y < grid.tiles_y(); ++y) {
    for (std::int32_t x = 0; x < grid.tiles_x(); ++x) meshes.push_back(mesh_tile(solid, {x, y}));
  }
  return meshes;
}

/// Defects of a set of tile meshes as one surface. Vertices are identical if their bits are.
struct MeshReport {
  std::size_t triangles = 0;
  std::size_t open_edges = 0;      ///< directed edges without exactly one opposite
  std::size_t repeated_edges = 0;  ///< directed edges that two triangles share
  std::size_t degenerate = 0;      ///< triangles with two equal corners
  std::size_t bad_normals = 0;     ///< not of unit length
  double volume_mm3 = 0;           ///< positive if the triangles face outward
  std::uint64_t hash = 0;          ///< over all bits, in order
};

struct PositionHash {
  std::size_t operator()(const std::array<float, 3>& p) const {
    std::uint64_t h = 14695981039346656037U;
    for (const float c : p) h = (h ^ std::bit_cast<std::uint32_t>(c)) * 1099511628211U;
    return h ^ (h >> 29U);
  }
};

inline MeshReport check_mesh(const std::vector<TileMesh>& meshes) {
  MeshReport report;
  std::unordered_map<std::array<float, 3>, std::uint64_t, PositionHash> number;
  std::unordered_map<std::uint64_t, int> edges;
  report.hash = 14695981039346656037U;
  const auto mix = [&report](std::uint32_t bits) {
    report.hash = (report.hash ^ bits) * 1099511628211U;
  };
  for (const TileMesh& mesh : meshes) {
    std::vector<std::uint64_t> vertex;
    for (std::size_t v = 0; v < mesh.positions_mm.size(); ++v) {
      vertex.push_back(number.emplace(mesh.positions_mm[v], number.size()).first->second);
      const auto& n = mesh.normals[v];
      const float length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
      report.bad_normals += std::abs(length - 1) < 1e-4F ? 0 : 1;
      for (int c = 0; c < 3; ++c) {
        mix(std::bit_cast<std::uint32_t>(mesh.positions_mm[v][std::size_t(c)]));
        mix(std::bit_cast<std::uint32_t>(n[std::size_t(c)]));
      }
    }
    for (std::size_t t = 0; t + 2 < mesh.indices.size(); t += 3) {
      ++report.triangles;
      std::array<Vec3, 3> p;
      for (std::size_t c = 0; c < 3; ++c) {
        const std::uint32_t a = mesh.indices[t + c];
        const std::uint32_t b = mesh.indices[t + (c + 1) % 3];
        mix(a);
        report.degenerate += vertex[a] == vertex[b] ? 1 : 0;
        ++edges[vertex[a] << 32U | vertex[b]];
        const auto& q = mesh.positions_mm[a];
        p[c] = {double(q[0]), double(q[1]), double(q[2])};
      }
      report.volume_mm3 += dot(p[0], cross(p[1], p[2])) / 6;
    }
  }
  for (const auto& [edge, count] : edges) {
    report.repeated_edges += count > 1 ? 1 : 0;
    const auto opposite = edges.find(edge << 32U | edge >> 32U);
    report.open_edges += opposite == edges.end() || opposite->second != count ? 1 : 0;
  }
  return report;
}

}  // namespace kerf::test
