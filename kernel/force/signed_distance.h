// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernel/force/obstacle.h"

namespace kerf {

/// Signed distance of a point from an obstacle's surface (mm, negative inside) and the unit
/// direction in which it grows.
struct SignedDistance {
  double distance_mm;
  Vec3 outward;
};

SignedDistance signed_distance(const BoxObstacle& box, Vec3 point_mm);
SignedDistance signed_distance(const CylinderObstacle& cylinder, Vec3 point_mm);
SignedDistance signed_distance(const SphereObstacle& sphere, Vec3 point_mm);
/// The nearest triangle decides the distance; whether an upward ray leaves through an odd number of
/// triangles decides the side. O(triangles).
SignedDistance signed_distance(const MeshObstacle& mesh, Vec3 point_mm);

}  // namespace kerf
