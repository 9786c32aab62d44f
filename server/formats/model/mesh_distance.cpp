// SPDX-License-Identifier: Apache-2.0
#include "server/formats/model/mesh_distance.h"

#include <algorithm>
#include <cmath>

#include "kernel/math/nearest_on_triangle.h"

namespace kerf {
namespace {

std::uint64_t edge_key(std::uint32_t a, std::uint32_t b) {
  return std::uint64_t{std::min(a, b)} << 32U | std::max(a, b);
}

}  // namespace

MeshDistance::MeshDistance(const IndexedMesh& mesh) : mesh_(mesh), nearest_(mesh) {
  vertex_normals_.resize(mesh.positions_mm.size());
  edges_.reserve(mesh.triangles.size() * 3);
  for (std::uint32_t n = 0; n < mesh.triangles.size(); ++n) {
    const auto& t = mesh.triangles[n];
    const auto p = mesh.corners(n);
    const Vec3 normal = facet_normal(n);
    for (std::size_t c = 0; c < 3; ++c) {
      edges_.emplace_back(edge_key(t[c], t[(c + 1) % 3]), n);
      const Vec3 a = normalized(p[(c + 1) % 3] - p[c]), b = normalized(p[(c + 2) % 3] - p[c]);
      const double angle = std::acos(std::clamp(dot(a, b), -1.0, 1.0));
      vertex_normals_[t[c]] = vertex_normals_[t[c]] + normal * angle;
    }
  }
  std::ranges::sort(edges_);
}

Vec3 MeshDistance::facet_normal(std::uint32_t triangle) const {
  const auto [a, b, c] = mesh_.corners(triangle);
  return normalized(cross(b - a, c - a));
}

Vec3 MeshDistance::edge_normal(std::uint32_t from, std::uint32_t to) const {
  const std::uint64_t key = edge_key(from, to);
  Vec3 sum;
  const auto first = std::ranges::lower_bound(edges_, std::pair{key, std::uint32_t{0}});
  for (auto side = first; side != edges_.end() && side->first == key; ++side) {
    sum = sum + facet_normal(side->second);
  }
  return sum;
}

double MeshDistance::distance_mm(Vec3 point_mm, std::uint32_t& near) const {
  const MeshNearest::Found best = nearest_.find(point_mm - mesh_.origin_mm, near);
  near = best.triangle;
  return std::sqrt(best.squared_mm2);
}

double MeshDistance::signed_distance_mm(Vec3 point_mm, std::uint32_t& near) const {
  const Vec3 point = point_mm - mesh_.origin_mm;
  const MeshNearest::Found best = nearest_.find(point, near);
  near = best.triangle;
  const auto& t = mesh_.triangles[best.triangle];
  const NearestOnTriangle found = nearest_on_triangle(mesh_.corners(best.triangle), point);
  Vec3 normal;
  switch (found.on) {
    case TrianglePart::kA:
    case TrianglePart::kB:
    case TrianglePart::kC:
      normal = vertex_normals_[t[static_cast<std::size_t>(found.on)]];
      break;
    case TrianglePart::kAb:
      normal = edge_normal(t[0], t[1]);
      break;
    case TrianglePart::kBc:
      normal = edge_normal(t[1], t[2]);
      break;
    case TrianglePart::kCa:
      normal = edge_normal(t[2], t[0]);
      break;
    case TrianglePart::kInside:
      normal = facet_normal(best.triangle);
      break;
  }
  const double distance = std::sqrt(best.squared_mm2);
  return dot(point - found.point, normal) < 0 ? -distance : distance;
}

}  // namespace kerf
