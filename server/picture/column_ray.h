// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "kernel/dexel/dexel_snapshot.h"
#include "kernel/math/vec3.h"

namespace kerf {

/// The point where a ray enters the stock.
struct RayHit {
  Vec3 point_mm;
  Vec3 normal;          ///< of the surface there: unit, outward
  bool is_cut = false;  ///< not on the original surface of the stock
};

/// Returns the first point at which the ray from `from_mm` along the unit vector `towards` enters
/// the solid of a field along Z, or nullopt. Walks from column to column (Amanatides and Woo, 1987)
/// and skips blocks of columns below the ray: at most columns_x + columns_y steps.
std::optional<RayHit> first_hit(const DexelSnapshot& field, Vec3 from_mm, Vec3 towards);

/// Returns whether such a ray meets the solid.
bool meets_stock(const DexelSnapshot& field, Vec3 from_mm, Vec3 towards);

}  // namespace kerf
