// SPDX-License-Identifier: Apache-2.0
#include "server/verify/gouge_check.h"

#include <utility>

namespace kerf {

GougeCheck::GougeCheck(const GougeReference& reference, DexelSnapshot before, DexelSnapshot after,
                       const std::vector<FieldTile>& cut)
    : rows_(std::move(before), std::move(after), cut),
      columns_(*reference.part, reference.tolerance_mm) {}

bool GougeCheck::advance(std::size_t distances) {
  return rows_.advance(distances, [this](std::int32_t i, std::int32_t j) {
    const std::size_t before = columns_.distances();
    measure(i, j);
    return columns_.distances() - before;
  });
}

void GougeCheck::measure(std::int32_t i, std::int32_t j) {
  const auto found = columns_.gouge(rows_.before(), rows_.after(), i, j);
  if (!found || (deepest_ && found->depth_mm <= deepest_->depth_mm)) return;
  const DexelGrid& grid = rows_.after().grid();
  deepest_ = {found->depth_mm, {grid.x_mm(i), grid.y_mm(j), found->z_mm}};
}

}  // namespace kerf
