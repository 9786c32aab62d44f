// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <string_view>

#include "kernel/math/vec3.h"

namespace kerf {

/// The active plane (G17, G18, G19). Its normal is the third axis.
enum class ArcPlane { kXy, kZx, kYz };

/// A point in the coordinates of a plane, mm: along its first and second axis (X Y, Z X or Y Z) and
/// along its normal.
struct PlanePoint {
  double first = 0, second = 0, normal = 0;
};
/// Converts a point to the coordinates of a plane.
PlanePoint in_plane(Vec3 point, ArcPlane plane);
/// Inverse of in_plane.
Vec3 from_plane(PlanePoint point, ArcPlane plane);

/// Distance of two points projected into the plane.
inline double distance(PlanePoint a, PlanePoint b) {
  return std::hypot(b.first - a.first, b.second - a.second);
}
/// The axes of a plane, the first two and the normal: "zxy".
inline std::string_view plane_letters(ArcPlane plane) {
  return plane == ArcPlane::kXy ? "xyz" : plane == ArcPlane::kZx ? "zxy" : "yzx";
}
/// Direction from one point to another in the plane, rad, from the plane's first axis.
inline double direction(PlanePoint from, PlanePoint to) {
  return std::atan2(to.second - from.second, to.first - from.first);
}
/// The point at a distance in a direction (rad) from another, at the same height.
inline PlanePoint offset_point(PlanePoint from, double distance, double direction_rad) {
  return {from.first + distance * std::cos(direction_rad),
          from.second + distance * std::sin(direction_rad), from.normal};
}

}  // namespace kerf
