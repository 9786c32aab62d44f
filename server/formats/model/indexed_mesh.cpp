// SPDX-License-Identifier: Apache-2.0
#include "server/formats/model/indexed_mesh.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

#include "server/formats/model/vertex_welder.h"

namespace kerf {
namespace {

constexpr std::size_t kPieceTriangles = 16384;
/// cos 40 degrees: edges below this angle are shaded smooth.
constexpr double kCreaseCos = 0.766;

std::uint64_t edge_key(std::uint32_t from, std::uint32_t to) {
  return std::uint64_t{std::min(from, to)} << 32U | std::max(from, to);
}

}  // namespace

IndexedMesh indexed_mesh(const TriangleMesh& mesh) {
  constexpr double kFar = std::numeric_limits<double>::infinity();
  Vec3 low{kFar, kFar, kFar};
  for (const Vec3& v : mesh.vertices_mm) {
    low = {std::min(low.x, v.x), std::min(low.y, v.y), std::min(low.z, v.z)};
  }
  IndexedMesh indexed{low, {}, mesh.triangles};
  for (const Vec3& v : mesh.vertices_mm) {
    const Vec3 p = v - low;
    indexed.positions_mm.push_back(
        {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)});
  }
  return indexed;
}

IndexedMesh collect_mesh(MeshSource& source, const std::stop_token& stop) {
  IndexedMesh mesh{source.origin_mm(), {}, {}};
  VertexWelder welder;
  for (MeshPiece piece; !stop.stop_requested() && source.next(piece);) {
    const auto& welded = welder.weld(piece);
    for (const std::uint32_t n : welded.fresh) mesh.positions_mm.push_back(piece.positions_mm[n]);
    for (std::size_t t = 0; t + 2 < welded.indices.size(); t += 3) {
      mesh.triangles.push_back({welded.indices[t], welded.indices[t + 1], welded.indices[t + 2]});
    }
  }
  return mesh;
}

EdgeReport check_edges(std::span<const std::array<std::uint32_t, 3>> triangles) {
  // Sorting brings the half-edges of an edge together. The lowest bit is their direction.
  std::vector<std::pair<std::uint64_t, bool>> sides;
  sides.reserve(triangles.size() * 3);
  for (const auto& t : triangles) {
    for (std::size_t c = 0; c < 3; ++c) {
      const std::uint32_t from = t[c], to = t[(c + 1) % 3];
      sides.emplace_back(edge_key(from, to), from < to);
    }
  }
  std::ranges::sort(sides);
  EdgeReport report;
  for (std::size_t first = 0; first < sides.size();) {
    std::size_t end = first, up = 0;
    for (; end < sides.size() && sides[end].first == sides[first].first; ++end) {
      up += sides[end].second ? 1 : 0;
    }
    const std::size_t down = end - first - up;
    report.open += up != down ? 1 : 0;
    report.repeated += std::max(up, down) > 1 ? 1 : 0;
    if (up != 1 || down != 1) {
      report.vertices.push_back(static_cast<std::uint32_t>(sides[first].first >> 32U));
      report.vertices.push_back(static_cast<std::uint32_t>(sides[first].first));
    }
    first = end;
  }
  std::ranges::sort(report.vertices);
  const auto tail = std::ranges::unique(report.vertices);
  report.vertices.erase(tail.begin(), tail.end());
  return report;
}

WholeMesh::WholeMesh(const IndexedMesh& mesh) : mesh_(mesh) {
  for (const auto& p : mesh.positions_mm) {
    size_mm_ = {std::max(size_mm_.x, static_cast<double>(p[0])),
                std::max(size_mm_.y, static_cast<double>(p[1])),
                std::max(size_mm_.z, static_cast<double>(p[2]))};
  }
  first_.assign(mesh.positions_mm.size() + 1, 0);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto [a, b, c] = mesh.corners(t);
    facet_normals_.push_back(normalized(cross(b - a, c - a)));
    for (const std::uint32_t v : mesh.triangles[t]) ++first_[v + 1];
  }
  std::partial_sum(first_.begin(), first_.end(), first_.begin());
  around_.resize(mesh.triangles.size() * 3);
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (const std::uint32_t v : mesh.triangles[t]) {
      around_[next[v]++] = static_cast<std::uint32_t>(t);
    }
  }
}

Vec3 WholeMesh::corner_normal(std::size_t triangle, std::size_t corner) const {
  const std::uint32_t vertex = mesh_.triangles[triangle][corner];
  Vec3 sum;
  for (std::uint32_t n = first_[vertex]; n < first_[vertex + 1]; ++n) {
    const std::uint32_t other = around_[n];
    if (dot(facet_normals_[other], facet_normals_[triangle]) < kCreaseCos) continue;
    const auto& t = mesh_.triangles[other];
    const auto c = static_cast<std::size_t>(std::ranges::find(t, vertex) - t.begin());
    const Vec3 at = mesh_.position(vertex);
    const Vec3 a = normalized(mesh_.position(t[(c + 1) % 3]) - at);
    const Vec3 b = normalized(mesh_.position(t[(c + 2) % 3]) - at);
    sum = sum + facet_normals_[other] * std::acos(std::clamp(dot(a, b), -1.0, 1.0));
  }
  const Vec3 normal = normalized(sum);
  // A facet without area has no normal, so any unit vector serves.
  return normal == Vec3{} ? Vec3{0, 0, 1} : normal;
}

bool WholeMesh::next(MeshPiece& piece) {
  if (next_triangle_ >= mesh_.triangles.size()) return false;
  piece = {};
  std::map<std::pair<std::uint32_t, std::array<float, 3>>, std::uint32_t> numbers;
  const std::size_t end = std::min(next_triangle_ + kPieceTriangles, mesh_.triangles.size());
  for (; next_triangle_ < end; ++next_triangle_) {
    for (std::size_t c = 0; c < 3; ++c) {
      const std::uint32_t vertex = mesh_.triangles[next_triangle_][c];
      const Vec3 n = corner_normal(next_triangle_, c);
      const std::array<float, 3> normal{static_cast<float>(n.x), static_cast<float>(n.y),
                                        static_cast<float>(n.z)};
      const auto fresh = static_cast<std::uint32_t>(piece.positions_mm.size());
      const auto [place, added] = numbers.try_emplace({vertex, normal}, fresh);
      if (added) {
        piece.positions_mm.push_back(mesh_.positions_mm[vertex]);
        piece.normals.push_back(normal);
      }
      piece.indices.push_back(place->second);
    }
  }
  return true;
}

double WholeMesh::share() const {
  if (mesh_.triangles.empty()) return 1;
  return static_cast<double>(next_triangle_) / static_cast<double>(mesh_.triangles.size());
}

}  // namespace kerf
