// SPDX-License-Identifier: Apache-2.0
#include "server/formats/model/mesh_nearest.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "kernel/math/nearest_on_triangle.h"

namespace kerf {
namespace {

constexpr std::uint32_t kLeafTriangles = 4;

Vec3 plain(const std::array<float, 3>& p) {
  return {static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2])};
}

}  // namespace

MeshNearest::MeshNearest(const IndexedMesh& mesh) {
  const auto count = static_cast<std::uint32_t>(mesh.triangles.size());
  std::vector<Item> items(count);
  for (std::uint32_t n = 0; n < count; ++n) {
    items[n].triangle = n;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      items[n].middle[axis] = 0;
      for (const std::uint32_t v : mesh.triangles[n])
        items[n].middle[axis] += mesh.positions_mm[v][axis];
    }
  }
  corners_.reserve(count);
  triangle_.reserve(count);
  nodes_.reserve(count);
  build(items, mesh, 0, count);
  place_.resize(count);
  for (std::uint32_t n = 0; n < count; ++n) place_[triangle_[n]] = n;
}

std::uint32_t MeshNearest::build(std::vector<Item>& items, const IndexedMesh& mesh,
                                 std::uint32_t first, std::uint32_t end) {
  const auto number = static_cast<std::uint32_t>(nodes_.size());
  if (end - first <= kLeafTriangles) {
    for (std::uint32_t n = first; n < end; ++n) {
      const auto& t = mesh.triangles[items[n].triangle];
      corners_.push_back(
          {mesh.positions_mm[t[0]], mesh.positions_mm[t[1]], mesh.positions_mm[t[2]]});
      triangle_.push_back(items[n].triangle);
    }
    nodes_.push_back(leaf(first, end));
    return number;
  }
  std::array<float, 3> low = items[first].middle, high = low;
  for (std::uint32_t n = first; n < end; ++n) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], items[n].middle[axis]);
      high[axis] = std::max(high[axis], items[n].middle[axis]);
    }
  }
  std::size_t longest = 0;
  for (std::size_t axis = 1; axis < 3; ++axis) {
    if (high[axis] - low[axis] > high[longest] - low[longest]) longest = axis;
  }
  const std::uint32_t half = first + (end - first) / 2;
  std::nth_element(items.begin() + first, items.begin() + half, items.begin() + end,
                   [longest](const Item& a, const Item& b) {
                     const float x = a.middle[longest], y = b.middle[longest];
                     return x < y || (x == y && a.triangle < b.triangle);
                   });
  nodes_.emplace_back();
  build(items, mesh, first, half);
  const std::uint32_t right = build(items, mesh, half, end);
  Node& node = nodes_[number];
  node.first = right;
  node.count = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    node.low[axis] = std::min(nodes_[number + 1].low[axis], nodes_[right].low[axis]);
    node.high[axis] = std::max(nodes_[number + 1].high[axis], nodes_[right].high[axis]);
  }
  return number;
}

MeshNearest::Node MeshNearest::leaf(std::uint32_t first, std::uint32_t end) const {
  Node node{corners_[first][0], corners_[first][0], first, end - first};
  for (std::uint32_t n = first; n < end; ++n) {
    for (const auto& corner : corners_[n]) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        node.low[axis] = std::min(node.low[axis], corner[axis]);
        node.high[axis] = std::max(node.high[axis], corner[axis]);
      }
    }
  }
  return node;
}

double MeshNearest::squared_to_box(const Node& node, Vec3 point) {
  const Vec3 below = plain(node.low) - point, above = point - plain(node.high);
  const Vec3 out{std::max({below.x, above.x, 0.0}), std::max({below.y, above.y, 0.0}),
                 std::max({below.z, above.z, 0.0})};
  return dot(out, out);
}

double MeshNearest::squared_to(std::uint32_t place, Vec3 point) const {
  const auto& [a, b, c] = corners_[place];
  const Vec3 away = point - nearest_on_triangle({plain(a), plain(b), plain(c)}, point).point;
  const double d = dot(away, away);
  // A triangle with two equal corners is skipped. Its neighbors contain its points.
  return d >= 0 ? d : std::numeric_limits<double>::infinity();
}

MeshNearest::Found MeshNearest::find(Vec3 point, std::uint32_t near, double enough_mm2) const {
  std::uint32_t best = place_[near];
  double best_mm2 = squared_to(best, point);
  // Every level halves the range, so the depth is at most 32.
  std::array<std::pair<double, std::uint32_t>, 64> stack;
  std::size_t height = 0;
  stack[height++] = {squared_to_box(nodes_[0], point), 0};
  while (height > 0 && best_mm2 > enough_mm2) {
    const auto [away, number] = stack[--height];
    if (away >= best_mm2) continue;
    const Node& node = nodes_[number];
    for (std::uint32_t n = node.first; n < node.first + node.count; ++n) {
      if (const double d = squared_to(n, point); d < best_mm2) best_mm2 = d, best = n;
    }
    if (node.count > 0) continue;
    std::pair left{squared_to_box(nodes_[number + 1], point), number + 1};
    std::pair right{squared_to_box(nodes_[node.first], point), node.first};
    if (left.first < right.first) std::swap(left, right);
    stack[height++] = left;  // the nearer one is visited first
    stack[height++] = right;
  }
  return {best_mm2, triangle_[best]};
}

}  // namespace kerf
