#pragma once

#include <cstdint>
#include <expected>
#include <string>

#include "kernel/dexel/dexel_snapshot.h"
#include "kernel/dexel/stock_shape.h"

namespace kerf {

/// What the untouched stock holds in column (i, j): its whole height, or nothing beside a cylinder.
/// A column whose centre is exactly on the cylinder's surface is solid.
inline bool stock_has_column(const StockShape& stock, const DexelGrid& grid, std::int32_t i,
                             std::int32_t j) {
  const auto* cylinder = std::get_if<CylinderStock>(&stock);
  if (cylinder == nullptr) return true;
  const double dx = grid.x_mm(i) - cylinder->center_x_mm;
  const double dy = grid.y_mm(j) - cylinder->center_y_mm;
  return dx * dx + dy * dy <= cylinder->radius_mm * cylinder->radius_mm;
}

/// Lays the grid under a stock: as many columns as have their centre within the stock's bounds (at
/// least one), and the finest power of two as depth quantum with which the height stays below 2^30
/// quanta (6e-8 mm for a block of 50 mm). Stock and pitch must have been validated.
DexelGrid make_grid(const StockShape& stock, double pitch_mm);

}  // namespace kerf
