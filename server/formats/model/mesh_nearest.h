// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "server/formats/model/indexed_mesh.h"

namespace kerf {

/// Finds the triangle of a mesh that is nearest to a point, by a bounding-volume tree. Immutable
/// and safe for concurrent use.
class MeshNearest {
 public:
  /// The mesh must have at least one triangle. It is copied, 36 bytes per triangle.
  explicit MeshNearest(const IndexedMesh& mesh);

  struct Found {
    double squared_mm2;
    std::uint32_t triangle;
  };
  /// Returns the nearest triangle and its squared distance from a point, which is relative to the
  /// mesh's origin. `near` is a hint, the index of a triangle. A good one is faster. Among equally
  /// near triangles the choice depends on the hint. The search may end early with any triangle
  /// within `enough_mm2`.
  Found find(Vec3 point, std::uint32_t near, double enough_mm2 = 0) const;

 private:
  using Corners = std::array<std::array<float, 3>, 3>;
  struct Node {
    std::array<float, 3> low, high;
    std::uint32_t first,
        count;  ///< range of corners_; count 0: inner node, first is its right child
  };
  struct Item {
    std::array<float, 3> middle;  ///< times three
    std::uint32_t triangle;
  };
  std::uint32_t build(std::vector<Item>& items, const IndexedMesh& mesh, std::uint32_t first,
                      std::uint32_t end);
  Node leaf(std::uint32_t first, std::uint32_t end) const;
  static double squared_to_box(const Node& node, Vec3 point);
  double squared_to(std::uint32_t place, Vec3 point) const;

  std::vector<Corners> corners_;         ///< in the order of the leaves
  std::vector<std::uint32_t> triangle_;  ///< their indices in the mesh
  std::vector<std::uint32_t> place_;     ///< the inverse
  std::vector<Node> nodes_;              ///< the left child of an inner node follows it
};

}  // namespace kerf
