// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/guides/surface_distance.h"

#include <algorithm>
#include <cmath>

namespace kerf::agent {

SurfaceDistance box_distance(Vec3 min_mm, Vec3 max_mm, Vec3 point_mm) noexcept {
  const Vec3 middle = (min_mm + max_mm) * 0.5;
  const Vec3 half = (max_mm - min_mm) * 0.5;
  const Vec3 p = point_mm - middle;
  const Vec3 sign{std::copysign(1.0, p.x), std::copysign(1.0, p.y), std::copysign(1.0, p.z)};
  const Vec3 over{std::abs(p.x) - half.x, std::abs(p.y) - half.y, std::abs(p.z) - half.z};
  const double greatest = std::max({over.x, over.y, over.z});
  if (greatest > 0) {
    const Vec3 outside{std::max(0.0, over.x) * sign.x, std::max(0.0, over.y) * sign.y,
                       std::max(0.0, over.z) * sign.z};
    return {length(outside), normalized(outside)};
  }
  if (greatest == over.x) return {greatest, {sign.x, 0, 0}};
  if (greatest == over.y) return {greatest, {0, sign.y, 0}};
  return {greatest, {0, 0, sign.z}};
}

SurfaceDistance cylinder_distance(Vec3 min_mm, Vec3 max_mm, Vec3 point_mm) noexcept {
  const Vec3 middle = (min_mm + max_mm) * 0.5;
  const Vec3 p = point_mm - middle;
  const double radius = (max_mm.x - min_mm.x) / 2;
  const double from_axis = std::hypot(p.x, p.y);
  const Vec3 radial = from_axis > 0 ? Vec3{p.x / from_axis, p.y / from_axis, 0} : Vec3{1, 0, 0};
  const Vec3 up{0, 0, std::copysign(1.0, p.z)};
  const double side = from_axis - radius;
  const double end = std::abs(p.z) - (max_mm.z - min_mm.z) / 2;
  if (side > 0 && end > 0) {
    const Vec3 outside = radial * side + up * end;
    return {length(outside), normalized(outside)};
  }
  return side >= end ? SurfaceDistance{side, radial} : SurfaceDistance{end, up};
}

}  // namespace kerf::agent
