// SPDX-License-Identifier: Apache-2.0
#include "kernel/force/triangle_tree.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "kernel/math/nearest_on_triangle.h"

namespace kerf {
namespace {

constexpr std::uint32_t kLeafTriangles = 4;
/// Deeper nodes are divided by number, to bound the depth of recursion.
constexpr int kDepthMax = 40;
/// Exceeds the rounding of a double to a float.
constexpr double kFloatShare = double(std::numeric_limits<float>::epsilon());
/// Rounding of a computed coordinate, in shares of the greatest one.
constexpr double kErrorShare = 64 * std::numeric_limits<double>::epsilon();

constexpr double coordinate(Vec3 v, int axis) { return axis == 0 ? v.x : axis == 1 ? v.y : v.z; }

double middle(const TriangleTree::Triangle& t, int axis) {
  return coordinate(t[0], axis) + coordinate(t[1], axis) + coordinate(t[2], axis);
}

}  // namespace

bool crosses_upward(const TriangleTree::Triangle& t, Vec3 p) {
  bool inside = false;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3 a = t[i], b = t[(i + 1) % 3];
    if ((a.y > p.y) != (b.y > p.y) && p.x < a.x + (b.x - a.x) * ((p.y - a.y) / (b.y - a.y))) {
      inside = !inside;
    }
  }
  if (!inside) return false;
  const Vec3 n = cross(t[1] - t[0], t[2] - t[0]);
  if (n.z == 0) return false;
  return t[0].z - (n.x * (p.x - t[0].x) + n.y * (p.y - t[0].y)) / n.z > p.z;
}

/// The nearest triangle so far. Boxes are visited up to slightly more than its distance, so that
/// rounding hides no equally near triangle.
struct TriangleTree::Search {
  Vec3 point;
  double squared = 1e300, limit = 1e300;
  std::uint32_t triangle = 0;
  double error_mm;

  void consider(const Triangle& t, std::uint32_t number) {
    const Vec3 to = point - nearest_on_triangle(t, point).point;
    const double d2 = dot(to, to);
    if (!(d2 < squared || (d2 == squared && number < triangle))) return;
    squared = d2;
    triangle = number;
    // An error e of a distance d changes its square by 2 d e + e² <= d² / n + (n + 1) e².
    constexpr double kShares = 1e6;
    limit = d2 * (1 + 1 / kShares) + (kShares + 1) * error_mm * error_mm;
  }
  double squared_to(const Node& node) const {
    double sum = 0;
    for (int a = 0; a < 3; ++a) {
      const double x = coordinate(point, a);
      const double away = std::max({double(node.lo[a]) - x, x - double(node.hi[a]), 0.0});
      sum += away * away;
    }
    return sum;
  }
};

TriangleTree::TriangleTree(const std::vector<Triangle>& triangles) : triangles_(triangles) {
  const auto count = static_cast<std::uint32_t>(triangles.size());
  order_.resize(count);
  for (std::uint32_t n = 0; n < count; ++n) order_[n] = n;
  build(0, count, 0);
  for (int a = 0; a < 3; ++a) {
    const double most =
        std::max(std::abs(double(nodes_[0].lo[a])), std::abs(double(nodes_[0].hi[a])));
    error_mm_ = std::max(error_mm_, kErrorShare * most);
  }
}

std::shared_ptr<const TriangleTree> make_triangle_tree(
    const std::vector<TriangleTree::Triangle>& triangles) {
  return std::make_shared<const TriangleTree>(triangles);
}

TriangleTree::Node TriangleTree::box_of(std::uint32_t first, std::uint32_t end) const {
  Node box{};
  for (int a = 0; a < 3; ++a) {
    double lo = 1e300, hi = -1e300;
    for (std::uint32_t n = first; n < end; ++n) {
      for (const Vec3& corner : triangles_[n]) {
        lo = std::min(lo, coordinate(corner, a));
        hi = std::max(hi, coordinate(corner, a));
      }
    }
    box.lo[a] = static_cast<float>(lo - kFloatShare * std::abs(lo));
    box.hi[a] = static_cast<float>(hi + kFloatShare * std::abs(hi));
  }
  return box;
}

void TriangleTree::build(std::uint32_t first, std::uint32_t end, int depth) {
  const std::size_t at = nodes_.size();
  nodes_.push_back(box_of(first, end));
  if (end - first <= kLeafTriangles) {
    nodes_[at].first = first;
    nodes_[at].count = end - first;
    return;
  }
  const std::uint32_t second = divide(first, end, nodes_[at], depth);
  build(first, second, depth + 1);
  nodes_[at].first = static_cast<std::uint32_t>(nodes_.size());
  build(second, end, depth + 1);
}

std::uint32_t TriangleTree::divide(std::uint32_t first, std::uint32_t end, const Node& box,
                                   int depth) {
  int axis = 0;
  for (int a = 1; a < 3; ++a) {
    if (box.hi[a] - box.lo[a] > box.hi[axis] - box.lo[axis]) axis = a;
  }
  const double at = 1.5 * (double(box.lo[axis]) + double(box.hi[axis]));
  std::uint32_t low = first, high = end;
  while (low < high) {
    if (middle(triangles_[low], axis) < at) {
      ++low;
    } else {
      std::swap(order_[low], order_[--high]);
      std::swap(triangles_[low], triangles_[high]);
    }
  }
  const bool is_even = low > first && low < end && depth < kDepthMax;
  return is_even ? low : first + (end - first) / 2;
}

void TriangleTree::nearest(const Node& node, Search& search) const {
  for (std::uint32_t n = 0; n < node.count; ++n) {
    search.consider(triangles_[node.first + n], order_[node.first + n]);
  }
  if (node.count > 0) return;
  const Node *near = &node + 1, *far = &nodes_[node.first];
  double near2 = search.squared_to(*near), far2 = search.squared_to(*far);
  if (far2 < near2) {
    std::swap(near, far);
    std::swap(near2, far2);
  }
  if (near2 <= search.limit) nearest(*near, search);
  if (far2 <= search.limit) nearest(*far, search);
}

bool TriangleTree::crossed(const Node& node, Vec3 p) const {
  // Not by z, because the height of a steep triangle is computed and may be anywhere.
  if (p.x > double(node.hi[0]) + error_mm_ || p.x < double(node.lo[0]) - error_mm_) return false;
  if (p.y > double(node.hi[1]) + error_mm_ || p.y < double(node.lo[1]) - error_mm_) return false;
  bool odd = false;
  for (std::uint32_t n = 0; n < node.count; ++n)
    odd ^= crosses_upward(triangles_[node.first + n], p);
  if (node.count > 0) return odd;
  return crossed(*(&node + 1), p) != crossed(nodes_[node.first], p);
}

TriangleTree::Found TriangleTree::find(Vec3 point) const {
  Search search{.point = point, .error_mm = error_mm_};
  nearest(nodes_[0], search);
  return {search.triangle, crossed(nodes_[0], point)};
}

}  // namespace kerf
