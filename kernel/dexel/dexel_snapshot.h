// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "kernel/dexel/column_shares.h"
#include "kernel/dexel/dexel.h"
#include "kernel/dexel/dexel_grid.h"
#include "kernel/dexel/dexel_tile.h"
#include "kernel/dexel/stock_column.h"
#include "kernel/dexel/stock_shape.h"
#include "kernel/dexel/tile_directory.h"

namespace kerf {

/// Returns the dexels of column (i, j) of stored tiles and the stock around them: sorted from the
/// bottom up, disjoint, with gaps > 0, and empty outside the grid. Valid until the next call with
/// `scratch`.
std::span<const Dexel> column_of(const TileDirectory& tiles, const StockShape& stock,
                                 const DexelGrid& grid, std::int32_t i, std::int32_t j,
                                 std::vector<Dexel>& scratch);

/// An immutable view of a dexel field. It is cheap to take and to copy, since nodes and tiles are
/// shared copy-on-write, and safe to read on any thread while the field changes.
class DexelSnapshot {
 public:
  /// `untouched` holds the tiles before the first cut of a block that began as a mesh.
  DexelSnapshot(const DexelGrid& grid, const StockShape& stock, const ColumnShares& shares,
                TileDirectory tiles, TileDirectory untouched);

  const DexelGrid& grid() const { return grid_; }
  const StockShape& stock() const { return stock_; }
  /// Returns each column's share of the pitch's square.
  const ColumnShares& shares() const { return shares_; }
  const TileDirectory& tiles() const { return tiles_; }
  /// Returns whether the tile is stored. An untouched tile has exactly the stock's shape.
  bool touched(TileIndex tile) const { return tiles_.find(tile) != nullptr; }
  /// Calls visit(TileIndex, const DexelTile&) for every stored tile, in an order that depends only
  /// on their indices.
  template <class Visit>
  void for_each_touched(Visit&& visit) const {
    tiles_.for_each(visit);
  }
  /// Returns the dexels of a column (column_of).
  std::span<const Dexel> column(std::int32_t i, std::int32_t j, std::vector<Dexel>& scratch) const {
    return column_of(tiles_, stock_, grid_, i, j, scratch);
  }
  /// Returns a column as its tile stores it, with normal codes, or an empty view outside the grid.
  /// Valid as long as this snapshot.
  ColumnView view(std::int32_t i, std::int32_t j) const { return view_in(tiles_, i, j); }
  /// Returns a column as view() did before the first cut.
  ColumnView untouched_view(std::int32_t i, std::int32_t j) const {
    return view_in(untouched_, i, j);
  }
  /// Returns whether an end of column (i, j) belongs to the untouched stock. `code` is the end's
  /// code.
  bool is_original(std::int32_t i, std::int32_t j, std::int32_t depth, bool is_top,
                   NormalCode code) const;
  /// Returns the surface normal at an end of column (i, j): unit, outward, in the field's frame.
  /// `code` is the end's code. If it is kStockNormal, the normal is that of the stock's shape.
  Vec3 normal(std::int32_t i, std::int32_t j, std::int32_t depth, bool is_top,
              NormalCode code) const {
    if (code != kStockNormal) return decode_normal(code);
    return stock_normal(stock_, grid_, i, j, depth, is_top);
  }
  /// Returns the solid volume, mm^3: the sum over columns of length x pitch^2 x share
  /// (ColumnShares). It is computed as the stock's volume minus the material missing from the
  /// touched tiles, which is counted in whole quanta.
  double volume_mm3() const;
  /// Hashes (FNV-1a) the grid, the stock's shape and the columns of every tile that differs from
  /// the stock. Equal solids of equal stock have equal hashes, whichever tiles are stored.
  /// O(touched tiles).
  std::uint64_t hash() const;

 private:
  ColumnView view_in(const TileDirectory& tiles, std::int32_t i, std::int32_t j) const;

  DexelGrid grid_;
  StockShape stock_;
  ColumnShares shares_;
  TileDirectory tiles_, untouched_;
};

}  // namespace kerf
