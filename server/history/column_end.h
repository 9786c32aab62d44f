// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "kernel/dexel/solid_snapshot.h"
#include "kernel/math/ray_axis.h"
#include "kernel/math/vec3.h"

namespace kerf {

/// An end of a column: a ray of a field enters or leaves the solid of a block.
struct ColumnEnd {
  RayAxis axis = RayAxis::kZ;  ///< of the field
  std::int32_t i = 0, j = 0;   ///< column
  std::int32_t depth = 0;      ///< quanta
  bool is_top = false;         ///< the solid is below, in the frame of the field
  Vec3 at_mm;                  ///< world
  Vec3 normal;                 ///< of the surface there: unit, outward, world
  double distance_mm = 0;      ///< from the requested point
  friend bool operator==(const ColumnEnd&, const ColumnEnd&) = default;
};

/// Returns the end of a column of a solid that is nearest to a point, mm, and whose normal is
/// within 60 degrees of a unit vector, over all fields, among the columns around the point. Nullopt
/// if none is within `within_mm`, at most a few pitches, as on a wall along the rays of a single
/// field.
std::optional<ColumnEnd> nearest_end(const SolidSnapshot& solid, Vec3 place_mm, Vec3 normal,
                                     double within_mm);

}  // namespace kerf
