// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "server/formats/model/indexed_mesh.h"

namespace kerf {

/// Signed distance from points to a mesh: a tree of boxes over its triangles. The sign is that of
/// the pseudonormal at the nearest point (Bærentzen, Aanæs, Signed distance computation using the
/// angle weighted pseudonormal, 2005): negative inside a closed mesh. Immutable; any number of
/// threads may ask.
class MeshDistance {
 public:
  /// The mesh must outlive it and have a triangle.
  explicit MeshDistance(const IndexedMesh& mesh);

  /// Distance of a point of the scene, mm. `near` is a triangle that may be near (any number is
  /// right, a good one is quick) and becomes the nearest one; of several that are equally near,
  /// which one depends on it, the distance does not.
  double distance_mm(Vec3 point_mm, std::uint32_t& near) const;
  double signed_distance_mm(Vec3 point_mm, std::uint32_t& near) const;

 private:
  struct Node {
    std::array<float, 3> low, high;  ///< rounded outward
    std::uint32_t first, count;  ///< of order_; count 0: an inner node, first is its right child
  };
  struct Nearest {
    double squared_mm2;
    std::uint32_t triangle;
  };
  std::uint32_t build(std::uint32_t first, std::uint32_t end);
  Nearest nearest(Vec3 point, std::uint32_t near) const;
  double squared_to_box(const Node& node, Vec3 point) const;
  Vec3 facet_normal(std::uint32_t triangle) const;
  Vec3 edge_normal(std::uint32_t from, std::uint32_t to) const;

  const IndexedMesh& mesh_;
  std::vector<std::uint32_t> order_;
  std::vector<Node> nodes_;
  std::vector<Vec3> vertex_normals_;
  std::vector<std::pair<std::uint64_t, std::uint32_t>> edges_;  ///< sorted; edge, triangle
};

}  // namespace kerf
