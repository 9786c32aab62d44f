// SPDX-License-Identifier: Apache-2.0
#include "server/history/stock_cell.h"

#include <algorithm>
#include <vector>

namespace kerf {

bool was_stock(const SolidSnapshot& start, const StockCell& cell) {
  const auto field = std::ranges::find(start.fields, cell.axis,
                                       [](const DexelSnapshot& f) { return f.grid().axis; });
  if (field == start.fields.end()) return false;
  std::vector<Dexel> scratch;
  return std::ranges::any_of(field->column(cell.i, cell.j, scratch), [&](const Dexel& dexel) {
    return dexel.bottom <= cell.depth && cell.depth < dexel.top;
  });
}

Bounds box_of(const StockCell& cell, const DexelGrid& grid, double margin_mm) {
  const Vec3 low{grid.x_mm(cell.i), grid.y_mm(cell.j), grid.z_mm(cell.depth)};
  const Vec3 high{low.x, low.y, grid.z_mm(cell.depth + 1)};
  return grown({from_frame(cell.axis, low), from_frame(cell.axis, high)}, margin_mm);
}

}  // namespace kerf
