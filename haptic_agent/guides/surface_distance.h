// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernel/math/vec3.h"

namespace kerf::agent {

/// Signed distance to a surface, negative inside, and the unit direction in which it grows fastest.
struct SurfaceDistance {
  double distance_mm = 0;
  Vec3 normal{0, 0, 1};
};

/// Returns the distance from a box. Inside, the nearest face counts.
SurfaceDistance box_distance(Vec3 min_mm, Vec3 max_mm, Vec3 point_mm) noexcept;

/// Returns the distance from the upright cylinder inscribed in a box: its radius is half of the
/// box's extent in X. Inside, the nearer of side and end counts.
SurfaceDistance cylinder_distance(Vec3 min_mm, Vec3 max_mm, Vec3 point_mm) noexcept;

}  // namespace kerf::agent
