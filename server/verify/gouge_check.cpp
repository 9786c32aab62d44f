// SPDX-License-Identifier: Apache-2.0
#include "server/verify/gouge_check.h"

#include <utility>

namespace kerf {
namespace {

/// Cost of comparing a row of a tile, in 1/32 of a distance.
constexpr std::size_t kRowsOfDistance = 32;

}  // namespace

GougeCheck::GougeCheck(const GougeReference& reference, DexelSnapshot before, DexelSnapshot after,
                       const std::vector<FieldTile>& cut)
    : rows_(std::move(before), std::move(after), cut),
      columns_(*reference.part, reference.tolerance_mm) {}

bool GougeCheck::advance(std::size_t distances) {
  const std::size_t distances_end = columns_.distances() + distances;
  const std::size_t rows_end = rows_.visited() + distances * kRowsOfDistance;
  while (!rows_.is_done()) {
    if (columns_.distances() >= distances_end || rows_.visited() >= rows_end) return false;
    rows_.visit_next([this](std::int32_t i, std::int32_t j) { measure(i, j); });
  }
  return true;
}

void GougeCheck::measure(std::int32_t i, std::int32_t j) {
  const auto found = columns_.gouge(rows_.before(), rows_.after(), i, j);
  if (!found || (deepest_ && found->depth_mm <= deepest_->depth_mm)) return;
  const DexelGrid& grid = rows_.after().grid();
  deepest_ = {found->depth_mm, {grid.x_mm(i), grid.y_mm(j), found->z_mm}};
}

}  // namespace kerf
