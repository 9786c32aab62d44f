// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "kernel/math/vec3.h"
#include "kernel/surface/tile_mesh.h"

namespace kerf {

/// The surface of a solid meshed several times finer than the mesh under test; locates features
/// that the coarser lattice cannot represent.
class FineSurface {
 public:
  /// `size_mm` is the approximate radius of the queries.
  FineSurface(const std::vector<TileMesh>& meshes, double size_mm);

  /// Returns true if one lattice cell can represent the surface within `radius_mm` of a point: one
  /// face without a crease, two faces that meet in a crease, or three that meet in a corner. A face
  /// is a region connected without crossing a crease or leaving the ball; it may turn by up to 60
  /// degrees, and two faces may meet at 30 degrees or more. Anything else is a feature below that
  /// size: a thin wall, narrow gap, step, narrow strip, small radius or sharp edge.
  bool plain(Vec3 point, double radius_mm) const;

 private:
  struct Triangle {
    std::array<std::uint32_t, 3> corners;
    Vec3 normal;
    double area_mm2;
    std::array<std::uint32_t, 3> neighbours;  ///< across the edge from each corner to the next
  };
  struct Face {
    Vec3 normal_sum, first;
    double area_mm2 = 0;
    double turned = 1;  ///< smallest cosine to the first normal
    std::vector<std::uint32_t> triangles;
  };

  void join_neighbours();
  void fill_boxes();
  std::int64_t box_of(std::int64_t x, std::int64_t y, std::int64_t z) const;
  std::vector<std::uint32_t> near(Vec3 point, double radius_mm) const;
  std::vector<Face> faces(const std::vector<std::uint32_t>& near, double radius_mm) const;
  bool meet(const std::vector<Face>& faces, double reach_mm) const;
  double distance(Vec3 point, const Triangle& triangle) const;

  double size_mm_;
  std::vector<Vec3> corners_;
  std::vector<Triangle> triangles_;
  std::unordered_map<std::int64_t, std::vector<std::uint32_t>> boxes_;
};

}  // namespace kerf
