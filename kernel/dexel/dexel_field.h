#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "kernel/dexel/dexel_snapshot.h"
#include "kernel/dexel/dexel_tile.h"

namespace kerf {

/// The stock that is being cut: a grid of columns along one axis in lazily allocated tiles (paper
/// section 2.1, Fig. 2a). An untouched tile is not stored. A tile that a snapshot holds is copied
/// before it is next changed, so taking a snapshot costs no column and readers on other threads
/// never wait.
class DexelField {
 public:
  /// Stock and pitch must have been validated (Sculpture::create does).
  DexelField(const StockShape& stock, double pitch_mm, RayAxis axis = RayAxis::kZ);

  const DexelGrid& grid() const { return grid_; }
  const StockShape& stock() const { return stock_; }

  /// The tile as stored, or null while it is untouched.
  const DexelTile* find(TileIndex tile) const { return tiles_[index(tile)].get(); }
  /// The tile to be changed: made from the stock's shape if untouched, copied if a snapshot holds
  /// it.
  DexelTile& edit(TileIndex tile);
  DexelSnapshot snapshot();
  /// Volume of the untouched stock in columns, mm^3.
  double stock_volume_mm3() const;

 private:
  std::size_t index(TileIndex tile) const {
    return std::size_t(tile.y) * std::size_t(grid_.tiles_x()) + std::size_t(tile.x);
  }
  std::shared_ptr<DexelTile> make_tile(TileIndex tile) const;

  StockShape stock_;
  DexelGrid grid_;
  std::vector<std::shared_ptr<DexelTile>> tiles_;  ///< row-major; null where untouched
  std::uint64_t era_ = 1;  ///< grows with each snapshot; tiles of earlier eras are shared
};

}  // namespace kerf
