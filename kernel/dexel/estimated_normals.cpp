// SPDX-License-Identifier: Apache-2.0
#include "kernel/dexel/estimated_normals.h"

#include <cstdlib>
#include <optional>
#include <span>
#include <vector>

#include "kernel/dexel/dexel_tile.h"
#include "kernel/dexel/stock_column.h"

namespace kerf {
namespace {

constexpr double kReachPitches = 4;

enum class End { kBottom, kTop };

std::int32_t depth_of(const Dexel& dexel, End end) {
  return end == End::kTop ? dexel.top : dexel.bottom;
}

/// Slopes of the surface at the ends of a tile's elements. Codes may be written meanwhile.
class Slopes {
 public:
  Slopes(const DexelTile& tile, const DexelGrid& grid)
      : tile_(tile),
        reach_(kReachPitches * grid.pitch_mm / grid.z_quantum_mm),
        slope_per_quantum_(grid.z_quantum_mm / grid.pitch_mm) {}

  /// Returns the normal of an end, outward.
  Vec3 normal(int column, std::int32_t depth, End end) {
    const int x = column % kTileSide, y = column / kTileSide;
    const double along_x = slope(column, x, 1, depth, end);
    const double along_y = slope(column, y, kTileSide, depth, end);
    return end == End::kTop ? Vec3{-along_x, -along_y, 1} : Vec3{along_x, along_y, -1};
  }

 private:
  /// Returns the slope at an end along one direction, in which `n` is the column's index.
  double slope(int column, int n, int step, std::int32_t depth, End end) {
    const auto before = n > 0 ? nearest(column - step, depth, end) : std::nullopt;
    const auto after = n + 1 < kTileSide ? nearest(column + step, depth, end) : std::nullopt;
    if (!before && !after) return 0;
    const double columns = before && after ? 2 : 1;
    return (after.value_or(depth) - before.value_or(depth)) * slope_per_quantum_ / columns;
  }
  /// Returns the depth of the nearest end of a kind in a column, or nothing if none is near.
  std::optional<std::int32_t> nearest(int column, std::int32_t depth, End end) {
    tile_.read(column, scratch_);
    std::optional<std::int32_t> best;
    for (const Dexel& dexel : scratch_) {
      const std::int32_t other = depth_of(dexel, end);
      const std::int32_t distance = std::abs(other - depth);
      if (distance <= reach_ && (!best || distance < std::abs(*best - depth))) best = other;
    }
    return best;
  }

  const DexelTile& tile_;
  double reach_, slope_per_quantum_;
  std::vector<Dexel> scratch_;
};

/// Sets the normals of the ends of one element that have none and do not belong to the stock.
void estimate(Slopes& slopes, int column, const Dexel& dexel, const Dexel& whole, EndCodes& codes) {
  if (codes.bottom == kStockNormal && dexel.bottom != whole.bottom)
    codes.bottom = encode_normal(slopes.normal(column, dexel.bottom, End::kBottom));
  if (codes.top == kStockNormal && dexel.top != whole.top)
    codes.top = encode_normal(slopes.normal(column, dexel.top, End::kTop));
}

}  // namespace

void estimate_normals(DexelTile& tile, TileIndex at, const StockShape& stock,
                      const DexelGrid& grid) {
  Slopes slopes(tile, grid);
  for (int column = 0; column < kTileColumns; ++column) {
    const auto c = std::size_t(column);
    if (tile.bottom[c] >= tile.top[c]) continue;
    const Dexel whole = stock_column(stock, grid, at.x * kTileSide + column % kTileSide,
                                     at.y * kTileSide + column / kTileSide);
    estimate(slopes, column, {tile.bottom[c], tile.top[c]}, whole, tile.topmost_codes[c]);
    if (!tile.is_split(column)) continue;
    const std::span<EndCodes> codes = tile.lower_codes.edit(column);
    for (std::size_t n = 0; n < codes.size(); ++n) {
      estimate(slopes, column, tile.lower.of(column)[n], whole, codes[n]);
    }
  }
}

}  // namespace kerf
