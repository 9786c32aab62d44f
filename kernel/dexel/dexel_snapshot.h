#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "kernel/dexel/stock_shape.h"
#include "kernel/dexel/tile_index.h"
#include "kernel/math/ray_axis.h"

namespace kerf {

struct DexelTile;

/// One solid depth element of a column, in quanta above the block's lowest plane (see
/// DexelGrid::z_quantum_mm).
struct Dexel {
  std::int32_t bottom = 0, top = 0;  ///< bottom < top
  friend constexpr bool operator==(const Dexel&, const Dexel&) = default;
};

/// The regular grid of columns that a dexel field stands on, in the field's own frame (see
/// RayAxis). Column (i, j) is the ray along +Z through x = origin.x + (i + 1/2) pitch, y = origin.y
/// + (j + 1/2) pitch. A depth d stands for z = origin.z + d * z_quantum_mm.
struct DexelGrid {
  Vec3 origin_mm;           ///< minimum corner of the block
  double pitch_mm = 1;      ///< distance of neighbouring rays
  double z_quantum_mm = 1;  ///< a power of two; block height / quantum < 2^30
  std::int32_t columns_x = 0, columns_y = 0;
  std::int32_t height_quanta = 0;  ///< the block's height
  RayAxis axis = RayAxis::kZ;      ///< of the world: where the frame's Z points
  std::int32_t tiles_x() const { return (columns_x + kTileSide - 1) / kTileSide; }
  std::int32_t tiles_y() const { return (columns_y + kTileSide - 1) / kTileSide; }
  double x_mm(std::int32_t i) const { return origin_mm.x + (i + 0.5) * pitch_mm; }
  double y_mm(std::int32_t j) const { return origin_mm.y + (j + 0.5) * pitch_mm; }
  double z_mm(std::int32_t depth) const { return origin_mm.z + depth * z_quantum_mm; }
};

/// An immutable picture of a dexel field: cheap to take and to copy (tiles are shared until the
/// field changes them), safe to read on any thread while the field goes on changing.
class DexelSnapshot {
 public:
  DexelSnapshot(DexelGrid grid, StockShape stock,
                std::vector<std::shared_ptr<const DexelTile>> tiles);

  const DexelGrid& grid() const { return grid_; }
  /// False while the tile is still exactly the stock's shape (nothing is stored for it).
  bool touched(TileIndex tile) const;
  /// The solid elements of a column, sorted from the bottom up, disjoint, gaps > 0. `scratch` is
  /// used where the column is not stored in that form; the result is valid until the next call with
  /// the same scratch. Outside the grid: empty.
  std::span<const Dexel> column(std::int32_t i, std::int32_t j, std::vector<Dexel>& scratch) const;
  /// Solid volume, mm^3 (columns x pitch^2).
  double volume_mm3() const;
  /// FNV-1a over every column's solid elements in row-major order: equal for equal solids, touched
  /// or not.
  std::uint64_t hash() const;

 private:
  DexelGrid grid_;
  StockShape stock_;
  std::vector<std::shared_ptr<const DexelTile>> tiles_;  ///< row-major; null where untouched
};

}  // namespace kerf
