// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "kernel/dexel/triangle_mesh.h"
#include "server/verify/box_tree.h"

namespace kerf {

/// A closed mesh as an exact solid. A point is inside if the winding number is not 0, as for the
/// kernel (kernel/dexel/mesh_stock.h), so overlapping bodies are united and the mesh may be inside
/// out. Immutable and safe for concurrent use.
class StockMesh {
 public:
  /// The mesh must be closed (mesh_stock_fault).
  explicit StockMesh(const TriangleMesh& mesh);
  StockMesh(const StockMesh&) = delete;
  StockMesh& operator=(const StockMesh&) = delete;

  bool contains(Vec3 point_mm) const;
  /// The nearest triangle, which may be inside the solid where bodies overlap.
  struct Nearest {
    double mm;     ///< signed distance, negative inside the solid
    Vec3 outward;  ///< unit; direction in which the distance grows
  };
  /// Distances above `limit_mm` are returned as the limit, without a direction. A low limit is
  /// fast.
  Nearest nearest(Vec3 point_mm, double limit_mm) const;

  /// A point of a triangle and one of the triangle's unit normals.
  struct SurfacePoint {
    Vec3 mm, normal;
  };
  double area_mm2() const { return until_mm2_.empty() ? 0 : until_mm2_.back(); }
  /// Returns a point of the surface: `at_mm2` in [0, area_mm2()) selects the triangle, `a` and `b`
  /// in [0, 1) the point on it.
  SurfacePoint at(double at_mm2, double a, double b) const;

 private:
  std::array<Vec3, 3> corners(std::size_t triangle) const;
  std::size_t cell(double mm, std::size_t cells) const;
  void index_cells(Vec3 size_mm);

  Vec3 origin_mm_;  ///< of the vertices
  TriangleMesh mesh_;
  BoxTree tree_;                   ///< of the triangles
  std::vector<double> until_mm2_;  ///< area of this triangle and those before
  /// The triangles over each cell of a grid in x and y, cell by cell.
  double cell_mm_ = 1;
  std::size_t cells_x_ = 1, cells_y_ = 1;
  std::vector<std::uint32_t> first_, over_;
};

}  // namespace kerf
