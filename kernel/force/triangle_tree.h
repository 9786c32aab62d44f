// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "kernel/math/vec3.h"

namespace kerf {

/// Triangles in a tree of boxes, so that a query visits a few dozen of them, independently of their
/// number. Immutable and safe for concurrent use.
class TriangleTree {
 public:
  using Triangle = std::array<Vec3, 3>;
  /// Keeps a copy. `triangles` must be finite and not empty.
  explicit TriangleTree(const std::vector<Triangle>& triangles);

  /// Equal, to the bit, to the result of visiting all triangles in their order.
  struct Found {
    std::uint32_t nearest = 0;  ///< the first of equally near triangles
    bool inside = false;        ///< an upward ray crosses an odd number of triangles
  };
  Found find(Vec3 point_mm) const;

 private:
  struct Node {
    float lo[3], hi[3];  ///< rounded outward
    std::uint32_t
        first;  ///< of triangles_; of an inner node its second child, the first one follows it
    std::uint32_t count;  ///< 0 for an inner node
  };
  struct Search;
  void build(std::uint32_t first, std::uint32_t end, int depth);
  Node box_of(std::uint32_t first, std::uint32_t end) const;
  /// Divides triangles at the middle of the longest side of their box, or by number.
  std::uint32_t divide(std::uint32_t first, std::uint32_t end, const Node& box, int depth);
  void nearest(const Node& node, Search& search) const;
  bool crossed(const Node& node, Vec3 point_mm) const;

  std::vector<Triangle> triangles_;   ///< in the order of the leaves
  std::vector<std::uint32_t> order_;  ///< the original number of each of these
  std::vector<Node> nodes_;
  double error_mm_ = 0;  ///< rounding error of a computed coordinate
};

/// Builds a tree. Separate from the class, so that the page, which has no meshes, need not link it.
std::shared_ptr<const TriangleTree> make_triangle_tree(
    const std::vector<TriangleTree::Triangle>& triangles);

/// Returns whether the ray from p along +Z crosses the triangle. Edges are half-open, so a shared
/// edge counts once.
bool crosses_upward(const TriangleTree::Triangle& t, Vec3 p);

}  // namespace kerf
