// SPDX-License-Identifier: Apache-2.0
#include "server/picture/picture_rod.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace kerf {
namespace {

/// Whether the ray comes near enough to the ball around a rod to meet it.
bool comes_near(const PictureRod& rod, Vec3 from_mm, Vec3 towards) {
  const Vec3 arm = (rod.from_mm + rod.to_mm) * 0.5 - from_mm;
  const double along = dot(arm, towards);
  const double reach =
      0.5 * length(rod.to_mm - rod.from_mm) + std::max(rod.from_radius_mm, rod.to_radius_mm);
  return along > -reach && dot(arm, arm) - along * along <= reach * reach;
}

}  // namespace

std::optional<RodHit> meet(const PictureRod& rod, Vec3 from_mm, Vec3 towards) {
  if (!comes_near(rod, from_mm, towards)) return std::nullopt;
  const double height = length(rod.to_mm - rod.from_mm);
  const Vec3 axis = normalized(rod.to_mm - rod.from_mm), arm = from_mm - rod.from_mm;
  const double slope = (rod.to_radius_mm - rod.from_radius_mm) / height;
  const double h = dot(arm, axis), h_per_mm = dot(towards, axis);
  const double radius = rod.from_radius_mm + slope * h, radius_per_mm = slope * h_per_mm;
  std::optional<RodHit> nearest;
  const auto take = [&](double at, Vec3 normal) {
    if (at <= 0 || dot(normal, towards) >= 0 || (nearest && nearest->at_mm <= at)) return;
    nearest = RodHit{at, normal};
  };

  // The side: the squared distance from the axis is the squared radius.
  const double a = 1 - h_per_mm * h_per_mm - radius_per_mm * radius_per_mm;
  const double b = dot(arm, towards) - h * h_per_mm - radius * radius_per_mm;
  const double c = dot(arm, arm) - h * h - radius * radius;
  const double root = std::sqrt(std::max(0.0, b * b - a * c));
  if (a != 0 && b * b >= a * c) {
    for (const double at : {(-b - root) / a, (-b + root) / a}) {
      const double at_h = h + at * h_per_mm;
      if (at_h < 0 || at_h > height) continue;
      take(at, normalized(normalized(arm + towards * at - axis * at_h) - axis * slope));
    }
  }
  if (h_per_mm == 0) return nearest;
  struct End {
    double h, radius;
    Vec3 normal;
  };
  for (const End& end :
       std::array{End{0, rod.from_radius_mm, -axis}, End{height, rod.to_radius_mm, axis}}) {
    const double at = (end.h - h) / h_per_mm;
    const Vec3 off = arm + towards * at - axis * end.h;
    if (dot(off, off) <= end.radius * end.radius) take(at, end.normal);
  }
  return nearest;
}

}  // namespace kerf
