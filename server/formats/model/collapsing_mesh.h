// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "server/formats/model/indexed_mesh.h"

namespace kerf {

/// A triangle mesh with the triangles around each vertex. Vertices are removed by moving them to
/// the other end of an edge. Triangles and vertices keep their numbers.
class CollapsingMesh {
 public:
  using Triangle = std::array<std::uint32_t, 3>;
  static constexpr std::uint32_t kNone = UINT32_MAX;

  explicit CollapsingMesh(const IndexedMesh& mesh);

  /// All triangles; kNone for deleted ones.
  const std::vector<Triangle>& triangles() const { return triangles_; }
  bool is_gone(std::uint32_t triangle) const { return triangles_[triangle][0] == kNone; }
  /// The number of remaining triangles, and the triangles themselves.
  std::size_t size() const { return size_; }
  std::vector<Triangle> remaining() const;

  Vec3 position(std::uint32_t vertex) const { return positions_[vertex]; }
  std::array<Vec3, 3> corners(const Triangle& t) const {
    return {positions_[t[0]], positions_[t[1]], positions_[t[2]]};
  }

  /// Calls visit(triangle, corner) for the triangles around a vertex. `corner` is the vertex.
  /// Precondition: the vertex has triangles.
  template <class Visit>
  void for_around(std::uint32_t vertex, Visit&& visit) const {
    const std::uint32_t first = first_corner_[vertex];
    std::uint32_t corner = first;
    do {
      if (!is_gone(corner / 3)) visit(corner / 3, corner % 3);
      corner = next_corner_[corner];
    } while (corner != first);
  }

  /// Moves a vertex to another one and deletes the triangles that have both. Precondition: `around`
  /// are the triangles of `from`, some of which do not have `to`.
  void collapse(std::uint32_t from, std::uint32_t to, const std::vector<std::uint32_t>& around);

 private:
  void drop_gone(std::uint32_t vertex);

  std::vector<Triangle> triangles_;
  std::vector<Vec3> positions_;
  /// The corners at a vertex, 3 triangle + corner, form a ring.
  std::vector<std::uint32_t> first_corner_, next_corner_;
  std::size_t size_;
};

}  // namespace kerf
