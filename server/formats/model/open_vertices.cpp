// SPDX-License-Identifier: Apache-2.0
#include "server/formats/model/open_vertices.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <span>
#include <unordered_map>
#include <vector>

#include "kernel/dexel/mesh_stock.h"
#include "server/formats/model/mesh_shells.h"

namespace kerf {
namespace {

/// Vertices in cubes whose side is the joining distance.
class VertexCells {
 public:
  VertexCells(std::span<const Vec3> vertices, Vec3 origin, double distance_mm)
      : vertices_(vertices), origin_(origin), distance_mm_(distance_mm) {}

  /// Returns the first vertex added within the distance, or adds this one and returns it.
  std::uint32_t join(std::uint32_t vertex) {
    const Cell at = cell_of(vertices_[vertex]);
    for (std::int64_t n = 0; n < 27; ++n) {
      const auto cell = cells_.find({at[0] + n % 3 - 1, at[1] + n / 3 % 3 - 1, at[2] + n / 9 - 1});
      if (cell == cells_.end()) continue;
      for (const std::uint32_t other : cell->second) {
        if (length(vertices_[other] - vertices_[vertex]) <= distance_mm_) return other;
      }
    }
    cells_[at].push_back(vertex);
    return vertex;
  }

 private:
  using Cell = std::array<std::int64_t, 3>;
  struct CellHash {
    std::size_t operator()(const Cell& cell) const {
      std::uint64_t hash = 14695981039346656037U;
      for (const std::int64_t c : cell) {
        hash = (hash ^ static_cast<std::uint64_t>(c)) * 1099511628211U;
        hash ^= hash >> 31U;
      }
      return static_cast<std::size_t>(hash);
    }
  };

  Cell cell_of(Vec3 v) const {
    const Vec3 p = (v - origin_) * (1 / distance_mm_);
    return {std::int64_t(std::floor(p.x)), std::int64_t(std::floor(p.y)),
            std::int64_t(std::floor(p.z))};
  }

  std::span<const Vec3> vertices_;
  Vec3 origin_;
  double distance_mm_;
  std::unordered_map<Cell, std::vector<std::uint32_t>, CellHash> cells_;
};

/// A number that depends only on the two ends of an edge and their order.
std::uint64_t mixed(std::uint32_t from, std::uint32_t to) {
  std::uint64_t x = (std::uint64_t{from} << 32U | to) + 0x9e3779b97f4a7c15U;
  x = (x ^ (x >> 30U)) * 0xbf58476d1ce4e5b9U;
  x = (x ^ (x >> 27U)) * 0x94d049bb133111ebU;
  return x ^ (x >> 31U);
}

}  // namespace

bool seems_closed(const TriangleMesh& mesh) {
  std::uint64_t sum = 0;  // edges in opposite directions cancel
  for (const auto& t : mesh.triangles) {
    for (std::size_t c = 0; c < 3; ++c) {
      const std::uint32_t from = t[c], to = t[(c + 1) % 3];
      sum += from < to ? mixed(from, to) : -mixed(to, from);
    }
  }
  return sum == 0;
}

std::size_t join_open_vertices(TriangleMesh& mesh, double share) {
  const BoxStock box = mesh_bounds(mesh);
  const double distance_mm = share * length(box.max_mm - box.min_mm);
  if (!(distance_mm > 0) || !std::isfinite(distance_mm)) return 0;
  std::vector<bool> open(mesh.vertices_mm.size());
  for_each_edge(mesh, [&open](std::span<const EdgeUse> uses) {
    if (uses.size() == 1) open[uses[0].from] = open[uses[0].to] = true;
  });
  VertexCells cells(mesh.vertices_mm, box.min_mm, distance_mm);
  std::vector<std::uint32_t> joined(mesh.vertices_mm.size());
  std::iota(joined.begin(), joined.end(), 0U);
  std::size_t count = 0;
  for (std::uint32_t v = 0; v < joined.size(); ++v) {
    if (open[v]) joined[v] = cells.join(v);
    count += joined[v] == v ? 0 : 1;
  }
  for (auto& t : mesh.triangles) t = {joined[t[0]], joined[t[1]], joined[t[2]]};
  return count;
}

}  // namespace kerf
