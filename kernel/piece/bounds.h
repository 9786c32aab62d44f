// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>

#include "kernel/math/vec3.h"
#include "kernel/piece/extent.h"

namespace kerf {

/// A box with sides along the axes, mm.
struct Bounds {
  Vec3 lo_mm, hi_mm;
};

/// Returns the smallest box around two boxes.
inline Bounds joined(const Bounds& a, const Bounds& b) {
  return {{std::min(a.lo_mm.x, b.lo_mm.x), std::min(a.lo_mm.y, b.lo_mm.y),
           std::min(a.lo_mm.z, b.lo_mm.z)},
          {std::max(a.hi_mm.x, b.hi_mm.x), std::max(a.hi_mm.y, b.hi_mm.y),
           std::max(a.hi_mm.z, b.hi_mm.z)}};
}

/// Returns the intersection of two boxes, which must not be empty.
inline Bounds common(const Bounds& a, const Bounds& b) {
  return {{std::max(a.lo_mm.x, b.lo_mm.x), std::max(a.lo_mm.y, b.lo_mm.y),
           std::max(a.lo_mm.z, b.lo_mm.z)},
          {std::min(a.hi_mm.x, b.hi_mm.x), std::min(a.hi_mm.y, b.hi_mm.y),
           std::min(a.hi_mm.z, b.hi_mm.z)}};
}

/// Returns the box enlarged by `mm` on every side.
inline Bounds grown(const Bounds& box, double mm) {
  return {box.lo_mm - Vec3{mm, mm, mm}, box.hi_mm + Vec3{mm, mm, mm}};
}

/// Returns the support of a disc along a unit direction, relative to its center. `component` is the
/// component of the disc's unit normal in this direction.
inline double disc_half_width(double radius_mm, double component) {
  return radius_mm * std::sqrt(std::max(0.0, 1 - component * component));
}
/// Returns the supports along X, Y and Z.
inline Vec3 disc_half_widths(double radius_mm, Vec3 normal) {
  return {disc_half_width(radius_mm, normal.x), disc_half_width(radius_mm, normal.y),
          disc_half_width(radius_mm, normal.z)};
}

/// Returns the smallest box around the cylinder with this extent on the unit axis `axis` above
/// `tip_mm`.
inline Bounds cylinder_bounds(const Extent& extent, Vec3 tip_mm, Vec3 axis) {
  const Vec3 a = tip_mm + axis * extent.z0_mm, b = tip_mm + axis * extent.z1_mm;
  const Vec3 half = disc_half_widths(extent.radius_mm, axis);
  const Bounds spine = joined({a, a}, {b, b});
  return {spine.lo_mm - half, spine.hi_mm + half};
}

}  // namespace kerf
