// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "kernel/math/vec3.h"

namespace kerf {

/// The plane of an arc; the normal is the axis that is not in it.
enum class ArcPlane { kXy, kZx, kYz };

/// A point seen in a plane, mm: the plane's first and second axis (X Y, Z X or Y Z), and the third.
struct PlanePoint {
  double first = 0, second = 0, normal = 0;
};
PlanePoint in_plane(Vec3 point, ArcPlane plane);
Vec3 from_plane(PlanePoint point, ArcPlane plane);

inline double distance(PlanePoint a, PlanePoint b) {
  return std::hypot(b.first - a.first, b.second - a.second);
}
/// The angle of the way from one point to another, rad.
inline double direction(PlanePoint from, PlanePoint to) {
  return std::atan2(to.second - from.second, to.first - from.first);
}
/// The point `way` off in the direction of `angle`, rad.
inline PlanePoint offset_point(PlanePoint from, double way, double angle) {
  return {from.first + way * std::cos(angle), from.second + way * std::sin(angle), from.normal};
}

}  // namespace kerf
