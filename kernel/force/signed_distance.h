// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernel/force/obstacle.h"

namespace kerf {

/// The signed distance of a point from an obstacle's surface (mm, negative inside) and its unit
/// gradient.
struct SignedDistance {
  double distance_mm;
  Vec3 outward;
};

SignedDistance signed_distance(const BoxObstacle& box, Vec3 point_mm);
SignedDistance signed_distance(const CylinderObstacle& cylinder, Vec3 point_mm);
SignedDistance signed_distance(const SphereObstacle& sphere, Vec3 point_mm);
/// The distance is that from the nearest triangle. The point is inside if an upward ray crosses an
/// odd number of triangles. The mesh must have its tree.
SignedDistance signed_distance(const MeshObstacle& mesh, Vec3 point_mm);
SignedDistance signed_distance(const Obstacle& obstacle, Vec3 point_mm);

}  // namespace kerf
