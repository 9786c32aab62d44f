// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <variant>
#include <vector>

#include "kernel/math/vec3.h"

namespace kerf {

struct BoxObstacle {
  Vec3 min_mm, max_mm;
};
/// Upright or tilted cylinder between two points of its axis.
struct CylinderObstacle {
  Vec3 from_mm, to_mm;
  double radius_mm;
};
struct SphereObstacle {
  Vec3 center_mm;
  double radius_mm;
};
/// A closed triangle mesh of at most 1000 triangles, counter-clockwise seen from outside.
struct MeshObstacle {
  std::vector<std::array<Vec3, 3>> triangles;
};

/// Something the tool must not enter. It is never cut: it pushes back (paper Eqs. 25–26).
struct Obstacle {
  std::variant<BoxObstacle, CylinderObstacle, SphereObstacle, MeshObstacle> shape;
  double stiffness_n_per_mm = 1;
};

}  // namespace kerf
