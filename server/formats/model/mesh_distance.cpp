// SPDX-License-Identifier: Apache-2.0
#include "server/formats/model/mesh_distance.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "kernel/math/nearest_on_triangle.h"

namespace kerf {
namespace {

constexpr std::uint32_t kLeafTriangles = 4;

std::uint64_t edge_key(std::uint32_t a, std::uint32_t b) {
  return std::uint64_t{std::min(a, b)} << 32U | std::max(a, b);
}

double at(Vec3 v, std::size_t axis) { return axis == 0 ? v.x : axis == 1 ? v.y : v.z; }

}  // namespace

MeshDistance::MeshDistance(const IndexedMesh& mesh) : mesh_(mesh) {
  order_.resize(mesh.triangles.size());
  std::iota(order_.begin(), order_.end(), 0U);
  nodes_.reserve(order_.size());
  build(0, static_cast<std::uint32_t>(order_.size()));
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

std::uint32_t MeshDistance::build(std::uint32_t first, std::uint32_t end) {
  const auto number = static_cast<std::uint32_t>(nodes_.size());
  constexpr float kFar = std::numeric_limits<float>::max();
  Node node{{kFar, kFar, kFar}, {-kFar, -kFar, -kFar}, first, end - first};
  for (std::uint32_t n = first; n < end; ++n) {
    for (const std::uint32_t v : mesh_.triangles[order_[n]]) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        node.low[axis] = std::min(node.low[axis], mesh_.positions_mm[v][axis]);
        node.high[axis] = std::max(node.high[axis], mesh_.positions_mm[v][axis]);
      }
    }
  }
  nodes_.push_back(node);
  if (end - first <= kLeafTriangles) return number;
  std::size_t longest = 0;
  for (std::size_t axis = 1; axis < 3; ++axis) {
    if (node.high[axis] - node.low[axis] > node.high[longest] - node.low[longest]) longest = axis;
  }
  const auto middle = [&](std::uint32_t n) {
    const auto& t = mesh_.triangles[n];
    const auto& p = mesh_.positions_mm;
    return p[t[0]][longest] + p[t[1]][longest] + p[t[2]][longest];
  };
  const std::uint32_t half = first + (end - first) / 2;
  std::nth_element(order_.begin() + first, order_.begin() + half, order_.begin() + end,
                   [&](std::uint32_t a, std::uint32_t b) {
                     const float x = middle(a), y = middle(b);
                     return x < y || (x == y && a < b);
                   });
  build(first, half);
  const std::uint32_t right = build(half, end);
  nodes_[number].first = right;
  nodes_[number].count = 0;
  return number;
}

double MeshDistance::squared_to_box(const Node& node, Vec3 point) const {
  double sum = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double p = at(point, axis);
    const double away = std::max(
        {static_cast<double>(node.low[axis]) - p, p - static_cast<double>(node.high[axis]), 0.0});
    sum += away * away;
  }
  return sum;
}

MeshDistance::Nearest MeshDistance::nearest(Vec3 point, std::uint32_t near) const {
  const auto squared = [&](std::uint32_t triangle) {
    const Vec3 away = point - nearest_on_triangle(mesh_.corners(triangle), point).point;
    const double d = dot(away, away);
    // A triangle with two equal corners is skipped; its neighbors contain its points.
    return d >= 0 ? d : std::numeric_limits<double>::infinity();
  };
  Nearest best{squared(near), near};
  // Every level halves the range, so the depth is at most 32.
  std::array<std::pair<double, std::uint32_t>, 64> stack;
  std::size_t height = 0;
  stack[height++] = {squared_to_box(nodes_[0], point), 0};
  while (height > 0) {
    const auto [away, number] = stack[--height];
    if (away >= best.squared_mm2) continue;
    const Node& node = nodes_[number];
    for (std::uint32_t n = 0; n < node.count; ++n) {
      const std::uint32_t triangle = order_[node.first + n];
      if (const double d = squared(triangle); d < best.squared_mm2) best = {d, triangle};
    }
    if (node.count > 0) continue;
    std::pair left{squared_to_box(nodes_[number + 1], point), number + 1};
    std::pair right{squared_to_box(nodes_[node.first], point), node.first};
    if (left.first < right.first) std::swap(left, right);
    stack[height++] = left;  // the nearer one is visited first
    stack[height++] = right;
  }
  return best;
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
  const Nearest best = nearest(point_mm - mesh_.origin_mm, near);
  near = best.triangle;
  return std::sqrt(best.squared_mm2);
}

double MeshDistance::signed_distance_mm(Vec3 point_mm, std::uint32_t& near) const {
  const Vec3 point = point_mm - mesh_.origin_mm;
  const Nearest best = nearest(point, near);
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
