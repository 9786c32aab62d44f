// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "kernel/dexel/triangle_mesh.h"

namespace kerf {

/// Use of an edge by a triangle: along it, from its lower vertex number to the higher, or against.
struct EdgeUse {
  std::uint32_t from, to;
  std::uint32_t triangle;
  bool along;
};
/// Calls visit(uses) for each edge of a mesh, in ascending order, except those of zero length.
void for_each_edge(const TriangleMesh& mesh,
                   const std::function<void(std::span<const EdgeUse>)>& visit);

/// Triangles connected across edges of exactly two triangles.
struct MeshShell {
  std::vector<std::uint32_t> triangles;
  bool was_oriented = true;  ///< its triangles agreed in the file
  double volume_mm3 = 0;     ///< of a closed shell; negative if inside out
};

/// The shells of a mesh. Orients their triangles.
class MeshShells {
 public:
  /// The mesh must outlive this object. Its triangles need three different corners.
  explicit MeshShells(TriangleMesh& mesh);

  /// Orients the triangles of every shell like the larger part of its area. Returns a point where
  /// that is impossible: an edge of a one-sided surface.
  std::optional<Vec3> orient();
  std::size_t turned_triangles() const { return turned_; }

  std::span<MeshShell> all() { return shells_; }
  /// The volume of a closed shell, from its triangles.
  double volume_mm3(const MeshShell& shell) const;
  /// Whether the shell, one of all(), is inside another: a ray upward from the middle of its
  /// largest triangle crosses shells whose bounding box contains its own an odd number of times.
  /// Empty if all calls together have taken too long.
  std::optional<bool> is_inside_another(const MeshShell& shell);

 private:
  struct Box {
    Vec3 min_mm, max_mm;
  };
  std::array<Vec3, 3> corners(std::uint32_t triangle) const;
  double area_mm2(std::uint32_t triangle) const;
  Box box_of(const MeshShell& shell) const;
  static bool contains(const Box& outer, const Box& inner);

  TriangleMesh& mesh_;
  std::vector<std::vector<std::uint32_t>> neighbors_;
  std::vector<MeshShell> shells_;
  std::vector<Box> boxes_;  ///< of all shells, made on demand
  std::size_t turned_ = 0;
  std::uint64_t crossings_tested_ = 0;
};

/// Returns the boundaries of a shell, each as a ring of vertices in the order in which closing
/// triangles would use its edges.
std::vector<std::vector<std::uint32_t>> open_loops(const TriangleMesh& mesh,
                                                   const MeshShell& shell);

}  // namespace kerf
