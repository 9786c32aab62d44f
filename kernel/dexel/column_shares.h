// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <utility>

#include "kernel/dexel/dexel_grid.h"
#include "kernel/dexel/stock_shape.h"
#include "kernel/dexel/tile_index.h"

namespace kerf {

/// The shares by which the columns of a field count in volumes and forces. A share of 1 is the
/// square of the pitch. The last row and the last column represent the strip from the row before to
/// the side of the block: 0.5 to 1.5, or less in a block of one column. In a block that began as a
/// mesh, columns next to its walls represent the solid nearest to them (MeshShares). All other
/// columns count as 1, and so do all columns of a box that the pitch divides, up to rounding.
class ColumnShares {
 public:
  /// The shares of a tile's columns, row-major.
  using OfTile = std::array<float, kTileColumns>;

  ColumnShares(const StockShape& stock, const DexelGrid& grid);
  /// Sets the shares of tiles of a block that began as a mesh. In all other tiles the sides decide.
  void set_tiles(std::map<TileIndex, OfTile> shares) {
    if (!shares.empty())
      of_mesh_ = std::make_shared<const std::map<TileIndex, OfTile>>(std::move(shares));
  }

  /// Calls visit(TileIndex) for each of those tiles, in order.
  template <class Visit>
  void for_each_tile(Visit&& visit) const {
    if (!of_mesh_) return;
    for (const auto& [tile, shares] : *of_mesh_) visit(tile);
  }

  /// Returns the share of a column of the grid, or 1 beyond it.
  double of(std::int32_t i, std::int32_t j) const {
    if (const OfTile* tile = tile_at({i / kTileSide, j / kTileSide}))
      return double((*tile)[std::size_t(j % kTileSide * kTileSide + i % kTileSide)]);
    return of_column(i) * of_row(j);
  }
  /// Returns the factors of a share that the sides determine: by column, and by row.
  double of_column(std::int32_t i) const { return i == last_i_ ? last_x_ : 1; }
  double of_row(std::int32_t j) const { return j == last_j_ ? last_y_ : 1; }
  /// Computes the shares of columns i … i + 7 of row j, i a multiple of 8. Returns false, and
  /// leaves `shares` as they are, if all are 1.
  bool of_group(std::int32_t i, std::int32_t j, std::array<double, 8>& shares) const {
    const bool has_last = last_i_ >= i && last_i_ - i < 8;
    const bool by_sides = (has_last && last_x_ != 1) || (j == last_j_ && last_y_ != 1);
    return (by_sides || of_mesh_) && compute_group(i, j, shares);
  }
  /// Returns whether all columns of a tile have the share 1.
  bool are_whole(TileIndex tile) const {
    return (last_x_ == 1 || tile.x < last_i_ / kTileSide) &&
           (last_y_ == 1 || tile.y < last_j_ / kTileSide) && tile_at(tile) == nullptr;
  }
  /// Returns the bytes of the shares next to a mesh's walls.
  std::size_t bytes() const {
    return of_mesh_ ? of_mesh_->size() * sizeof(std::pair<TileIndex, OfTile>) : 0;
  }

 private:
  const OfTile* tile_at(TileIndex tile) const {
    if (!of_mesh_) return nullptr;
    const auto found = of_mesh_->find(tile);
    return found == of_mesh_->end() ? nullptr : &found->second;
  }
  bool compute_group(std::int32_t i, std::int32_t j, std::array<double, 8>& shares) const;

  std::int32_t last_i_, last_j_;
  double last_x_, last_y_;  ///< shares of the last column of a row, and of the last row
  std::shared_ptr<const std::map<TileIndex, OfTile>> of_mesh_;  ///< null if the sides alone decide
};

}  // namespace kerf
