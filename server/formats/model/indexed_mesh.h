// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <stop_token>
#include <vector>

#include "kernel/dexel/triangle_mesh.h"
#include "kernel/math/vec3.h"
#include "server/formats/model/mesh_source.h"

namespace kerf {

/// A complete surface in memory with shared vertices.
struct IndexedMesh {
  Vec3 origin_mm;  ///< scene coordinates of position (0, 0, 0)
  std::vector<std::array<float, 3>> positions_mm;
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< counter-clockwise seen from outside

  Vec3 position(std::uint32_t vertex) const {
    const auto& p = positions_mm[vertex];
    return {static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2])};
  }
  /// Returns the corners of a triangle, relative to the origin.
  std::array<Vec3, 3> corners(std::size_t triangle) const {
    const auto& t = triangles[triangle];
    return {position(t[0]), position(t[1]), position(t[2])};
  }
};

/// Returns a mesh with its positions in floats, relative to the least corner of its bounding box.
IndexedMesh indexed_mesh(const TriangleMesh& mesh);

/// Reads a whole source and merges its vertices. Needs about 24 bytes per triangle. Ends early,
/// with part of the surface, if a stop is requested.
IndexedMesh collect_mesh(MeshSource& source, const std::stop_token& stop = {});

/// Edges that violate a closed 2-manifold. Vertices are identified by their index.
struct EdgeReport {
  std::size_t open = 0;                 ///< edges with more triangles on one side than on the other
  std::size_t repeated = 0;             ///< edges that more than two triangles share
  std::vector<std::uint32_t> vertices;  ///< ends of such edges, sorted, each once
  bool closed_manifold() const { return open == 0 && repeated == 0; }
};
EdgeReport check_edges(std::span<const std::array<std::uint32_t, 3>> triangles);

/// Splits an indexed mesh into pieces. Vertex normals are the angle-weighted means over the
/// adjacent triangles, separate across edges of more than 40 degrees.
class WholeMesh final : public MeshSource {
 public:
  explicit WholeMesh(const IndexedMesh& mesh);
  Vec3 origin_mm() const override { return mesh_.origin_mm; }
  Vec3 size_mm() const override { return size_mm_; }
  bool next(MeshPiece& piece) override;
  double share() const override;

 private:
  Vec3 corner_normal(std::size_t triangle, std::size_t corner) const;

  const IndexedMesh& mesh_;
  Vec3 size_mm_;
  std::vector<Vec3> facet_normals_;
  std::vector<std::uint32_t> first_, around_;  ///< triangles around each vertex
  std::size_t next_triangle_ = 0;
};

}  // namespace kerf
