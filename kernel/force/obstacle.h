// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <variant>
#include <vector>

#include "kernel/math/vec3.h"

namespace kerf {

class TriangleTree;

/// A box with sides parallel to the coordinate axes.
struct BoxObstacle {
  Vec3 min_mm, max_mm;
};
/// A cylinder of any direction, between two points of its axis.
struct CylinderObstacle {
  Vec3 from_mm, to_mm;
  double radius_mm;
};
/// A ball.
struct SphereObstacle {
  Vec3 center_mm;
  double radius_mm;
};
/// A closed triangle mesh of at most kObstacleTrianglesMax triangles, counter-clockwise seen from
/// outside.
struct MeshObstacle {
  std::vector<std::array<Vec3, 3>> triangles;
  /// Tree of these triangles, built by Obstacles.
  std::shared_ptr<const TriangleTree> tree = {};
};
inline constexpr std::size_t kObstacleTrianglesMax = 200'000;

/// A fixed body that pushes the tool out (paper Eqs. 25, 26). It is never cut.
struct Obstacle {
  std::variant<BoxObstacle, CylinderObstacle, SphereObstacle, MeshObstacle> shape;
  double stiffness_n_per_mm = 1;
};

}  // namespace kerf
