// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "kernel/dexel/dexel.h"
#include "kernel/dexel/dexel_grid.h"
#include "kernel/dexel/stock_shape.h"

namespace kerf {

struct DexelTile;

/// Returns the bounding box of a stock.
BoxStock stock_bounds(const StockShape& stock);

/// Returns column (i, j) of the untouched stock: one element, or bottom == top if a ray misses a
/// cylinder. A ray parallel to the cylinder's axis is solid over its whole length or empty; on the
/// surface itself it is solid. A ray across the axis is solid on its chord, whose ends are rounded
/// to the nearest quantum. A tangent ray is empty.
Dexel stock_column(const StockShape& stock, const DexelGrid& grid, std::int32_t i, std::int32_t j);

/// Returns the normal of the untouched stock at the end of column (i, j) at a depth: unit, outward,
/// in the field's frame.
Vec3 stock_normal(const StockShape& stock, const DexelGrid& grid, std::int32_t i, std::int32_t j,
                  std::int32_t depth, bool is_top);

/// Fills a tile with the untouched stock. Columns beyond the grid are empty.
void fill_from_stock(const StockShape& stock, const DexelGrid& grid, TileIndex at, DexelTile& tile);

/// Returns the total length of all columns of the untouched stock, in quanta, each times its share
/// (ColumnShares). Needs at most O(columns along the grid's sides) evaluations.
double stock_quanta(const StockShape& stock, const DexelGrid& grid);

/// Returns the grid of the field along `axis` for a stock. Its columns are those whose center is
/// within the stock's bounds (at least one). Its depth quantum is the finest power of two for which
/// the field's height is below 2^30 quanta (6e-8 mm for a block of 50 mm). Stock and pitch must be
/// valid.
DexelGrid make_grid(const StockShape& stock, double pitch_mm, RayAxis axis = RayAxis::kZ);

/// Returns the number of columns that make_grid would create, for comparison with a limit. Infinite
/// if one side has more columns than an index can count.
double columns_in_field(const StockShape& stock, double pitch_mm, RayAxis axis);

}  // namespace kerf
