// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "kernel/dexel/dexel.h"
#include "kernel/dexel/dexel_grid.h"
#include "kernel/dexel/stock_shape.h"

namespace kerf {

struct DexelTile;

/// The box around a stock.
BoxStock stock_bounds(const StockShape& stock);

/// What the untouched stock holds in column (i, j): one element, or nothing (bottom == top) beside
/// a cylinder. Along the cylinder's axis a column is whole or empty, and one whose centre is
/// exactly on the surface is solid. Across it a column is a chord, its ends rounded to the nearest
/// quantum; a ray that only touches the cylinder meets nothing.
Dexel stock_column(const StockShape& stock, const DexelGrid& grid, std::int32_t i, std::int32_t j);

/// How the untouched stock looks at the end of column (i, j) at that depth, in the field's frame:
/// unit, outward.
Vec3 stock_normal(const StockShape& stock, const DexelGrid& grid, std::int32_t i, std::int32_t j,
                  std::int32_t depth, bool is_top);

/// Makes a tile what it is before any tool touches it; columns beyond the grid are empty.
void fill_from_stock(const StockShape& stock, const DexelGrid& grid, TileIndex at, DexelTile& tile);

/// Length of all columns of the untouched stock together, in quanta (a whole number, as far as a
/// double can hold it). Costs at most the columns along the grid's sides.
double stock_quanta(const StockShape& stock, const DexelGrid& grid);

/// Lays the grid of the field along `axis` under a stock: as many columns as have their centre
/// within the stock's bounds (at least one), and the finest power of two as depth quantum with
/// which the field's own height stays below 2^30 quanta (6e-8 mm for a block of 50 mm). Stock and
/// pitch must have been validated.
DexelGrid make_grid(const StockShape& stock, double pitch_mm, RayAxis axis = RayAxis::kZ);

/// Columns of that grid, without making it: a number of them that no field can have is not an error
/// here, and infinite where one side alone has more than its index can hold (2^30).
double columns_in_field(const StockShape& stock, double pitch_mm, RayAxis axis);

}  // namespace kerf
