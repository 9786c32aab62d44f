// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "kernel/dexel/dexel_grid.h"

namespace kerf {

/// A rectangle of tiles of one field: [begin, end) in x and y.
struct TileRegion {
  TileIndex begin, end;
  friend constexpr bool operator==(const TileRegion&, const TileRegion&) = default;

  /// Returns the number of tiles.
  std::int64_t count() const {
    return std::int64_t{std::max(end.x - begin.x, 0)} * std::max(end.y - begin.y, 0);
  }
  /// Returns whether a tile is in the region.
  bool has(TileIndex tile) const {
    return tile.x >= begin.x && tile.y >= begin.y && tile.x < end.x && tile.y < end.y;
  }
  /// Calls visit(tile) row by row until it returns false. Returns whether it always returned true.
  template <class Visit>
  bool all_of(Visit&& visit) const {
    for (std::int32_t y = begin.y; y < end.y; ++y) {
      for (std::int32_t x = begin.x; x < end.x; ++x) {
        if (!visit(TileIndex{x, y})) return false;
      }
    }
    return true;
  }
};

/// Returns the tiles whose rays, along the field's axis, meet a box, or an empty region if the box
/// is outside the block. The box is finite, in world coordinates.
inline TileRegion tiles_through(const DexelGrid& grid, Vec3 lo_mm, Vec3 hi_mm) {
  const Vec3 lo = to_frame(grid.axis, lo_mm), hi = to_frame(grid.axis, hi_mm);
  const double side_mm = kTileSide * grid.pitch_mm;
  const auto tile = [side_mm](double at_mm, double origin_mm, std::int32_t most) {
    const double n = std::floor((at_mm - origin_mm) / side_mm);
    return static_cast<std::int32_t>(std::clamp(n, -1.0, static_cast<double>(most)));
  };
  const std::int32_t nx = grid.tiles_x(), ny = grid.tiles_y();
  const TileRegion region{{std::max(tile(lo.x, grid.origin_mm.x, nx), 0),
                           std::max(tile(lo.y, grid.origin_mm.y, ny), 0)},
                          {std::min(tile(hi.x, grid.origin_mm.x, nx) + 1, nx),
                           std::min(tile(hi.y, grid.origin_mm.y, ny) + 1, ny)}};
  const bool beside_in_depth = hi.z < grid.origin_mm.z || lo.z > grid.z_mm(grid.height_quanta);
  return beside_in_depth ? TileRegion{} : region;
}

}  // namespace kerf
