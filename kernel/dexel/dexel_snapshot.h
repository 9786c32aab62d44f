// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "kernel/dexel/dexel.h"
#include "kernel/dexel/dexel_grid.h"
#include "kernel/dexel/dexel_tile.h"
#include "kernel/dexel/stock_column.h"
#include "kernel/dexel/stock_shape.h"
#include "kernel/dexel/tile_directory.h"

namespace kerf {

/// An immutable picture of a dexel field: cheap to take and to copy (everything is shared until the
/// field changes it), safe to read on any thread while the field goes on changing.
class DexelSnapshot {
 public:
  DexelSnapshot(const DexelGrid& grid, const StockShape& stock, TileDirectory tiles);

  const DexelGrid& grid() const { return grid_; }
  const StockShape& stock() const { return stock_; }
  /// False while the tile is still exactly the stock's shape (nothing is stored for it).
  bool touched(TileIndex tile) const { return tiles_.find(tile) != nullptr; }
  /// The solid elements of a column, sorted from the bottom up, disjoint, gaps > 0. `scratch` is
  /// used where the column is not stored in that form; the result is valid until the next call with
  /// the same scratch. Outside the grid: empty.
  std::span<const Dexel> column(std::int32_t i, std::int32_t j, std::vector<Dexel>& scratch) const;
  /// The same as it stands in the tile, valid as long as this snapshot; outside the grid: empty.
  ColumnView view(std::int32_t i, std::int32_t j) const;
  /// How the surface looks at an end of column (i, j), in the field's frame: unit, outward. `code`
  /// is the end's; the stock's own ends have the normal of its shape.
  Vec3 normal(std::int32_t i, std::int32_t j, std::int32_t depth, bool is_top,
              NormalCode code) const {
    if (code != kStockNormal) return decode_normal(code);
    return stock_normal(stock_, grid_, i, j, depth, is_top);
  }
  /// Solid volume, mm^3 (columns x pitch^2): the stock's, less what its touched tiles lack, which
  /// is counted exactly.
  double volume_mm3() const;
  /// FNV-1a over the grid, the stock's shape and the columns of every tile that differs from the
  /// stock: equal for equal solids of equal stock, touched or not. Costs what was touched.
  std::uint64_t hash() const;

 private:
  DexelGrid grid_;
  StockShape stock_;
  TileDirectory tiles_;
};

}  // namespace kerf
