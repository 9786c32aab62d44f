// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "server/formats/model/indexed_mesh.h"
#include "server/formats/model/mesh_nearest.h"

namespace kerf {

/// Computes signed distances from points to a mesh.
/// The sign is that of the angle-weighted pseudonormal at the nearest point (Bærentzen, Aanæs,
/// Signed distance computation using the angle weighted pseudonormal, 2005): negative inside a
/// closed mesh. Immutable and safe for concurrent use.
class MeshDistance {
 public:
  /// The mesh must outlive this object and have at least one triangle.
  explicit MeshDistance(const IndexedMesh& mesh);

  /// Returns the distance of a point in scene coordinates, mm. `near` is a hint, the index of a
  /// triangle that may be near (any value is valid, a good one is faster), and receives the nearest
  /// triangle. Among equally near ones the choice depends on the hint, the distance does not.
  double distance_mm(Vec3 point_mm, std::uint32_t& near) const;
  double signed_distance_mm(Vec3 point_mm, std::uint32_t& near) const;

 private:
  Vec3 facet_normal(std::uint32_t triangle) const;
  Vec3 edge_normal(std::uint32_t from, std::uint32_t to) const;

  const IndexedMesh& mesh_;
  MeshNearest nearest_;
  std::vector<Vec3> vertex_normals_;
  std::vector<std::pair<std::uint64_t, std::uint32_t>> edges_;  ///< sorted; edge, triangle
};

}  // namespace kerf
