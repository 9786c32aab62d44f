// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "kernel/math/vec3.h"

namespace kerf {

/// A straight rod drawn with a block: the shaft of an arrow, its head (a radius of 0 at one end), a
/// slice of a tool. A solid frustum with flat ends; its ends differ, and its radii are >= 0.
struct PictureRod {
  Vec3 from_mm, to_mm;
  double from_radius_mm = 0, to_radius_mm = 0;
  Vec3 color;  ///< linear, 0 to 1
};

/// The point where a ray enters a rod.
struct RodHit {
  double at_mm = 0;  ///< along the ray
  Vec3 normal;       ///< of the rod there: unit, outward
};

/// Returns where the ray from `from_mm` along the unit vector `towards` enters a rod, or nullopt if
/// it misses it or begins inside it.
std::optional<RodHit> meet(const PictureRod& rod, Vec3 from_mm, Vec3 towards);

}  // namespace kerf
