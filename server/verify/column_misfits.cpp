// SPDX-License-Identifier: Apache-2.0
#include "server/verify/column_misfits.h"

#include <algorithm>
#include <cmath>

#include "server/verify/column_sets.h"

namespace kerf {
namespace {

// An interval of a ray is sampled in steps of the distance to the part, but at least this fraction
// of the pitch.
constexpr double kStepShare = 0.5;

}  // namespace

std::optional<ColumnMisfit> ColumnMisfits::gouge(const DexelSnapshot& before,
                                                 const DexelSnapshot& after, std::int32_t i,
                                                 std::int32_t j) {
  subtract(before.column(i, j, whole_), after.column(i, j, left_), removed_);
  if (removed_.empty()) return std::nullopt;
  if (part_.material() == nullptr) {
    parts_.swap(removed_);
  } else {
    intersect(removed_, part_.material()->column(i, j, of_part_), parts_);
  }
  return walk(-1, i, j);
}

std::optional<ColumnMisfit> ColumnMisfits::rest(std::span<const Dexel> material, std::int32_t i,
                                                std::int32_t j) {
  subtract(material, part_.material()->column(i, j, of_part_), parts_);
  return walk(1, i, j);
}

// `side`: 1 outside the part, -1 inside.
std::optional<ColumnMisfit> ColumnMisfits::walk(double side, std::int32_t i, std::int32_t j) {
  ColumnMisfit found{.i = i, .j = j};
  for (const Dexel& element : parts_)
    if (!is_shallow(element)) walk(found, element, side);
  if (found.depth_mm <= tolerance_mm_) return std::nullopt;
  return found;
}

// No point of it is farther from the part's surface than from its end on that surface.
bool ColumnMisfits::is_shallow(const Dexel& element) const {
  if ((element.top - element.bottom) * part_.grid().z_quantum_mm > tolerance_mm_) return false;
  return std::ranges::any_of(of_part_, [&](const Dexel& d) {
    return d.bottom == element.bottom || d.top == element.top || d.top == element.bottom ||
           d.bottom == element.top;
  });
}

void ColumnMisfits::walk(ColumnMisfit& found, const Dexel& element, double side) {
  const DexelGrid& grid = part_.grid();
  const double low = grid.z_mm(element.bottom);
  const double high = grid.z_mm(element.top);
  const double least = kStepShare * grid.pitch_mm;
  for (double z = low; z <= high;) {
    const double depth = side * part_.surface().signed_distance_mm(
                                    {grid.x_mm(found.i), grid.y_mm(found.j), z}, near_);
    ++distances_;
    const double step = std::max(std::abs(depth), least);
    if (depth > 0) found.length_mm += std::min(step, high - z);
    if (depth > found.depth_mm) {
      found.depth_mm = depth;
      found.z_mm = z;
    }
    // The end of the interval is sampled as well.
    z = z < high ? std::min(z + step, high) : high + 1;
  }
}

}  // namespace kerf
