// SPDX-License-Identifier: Apache-2.0
#include "kernel/dexel/column_shares.h"

#include <cmath>
#include <limits>

#include "kernel/dexel/stock_column.h"

namespace kerf {
namespace {

/// Allowance for the rounding of a block's corners and pitch, relative to their size.
constexpr double kRounding = 4 * std::numeric_limits<double>::epsilon();

/// Returns the share of the last of `columns` columns between two sides of a block.
double last_share(double low_mm, double high_mm, double pitch_mm, std::int32_t columns) {
  const double laid_mm = columns * pitch_mm, beyond_mm = (high_mm - low_mm) - laid_mm;
  const double rounding_mm = kRounding * (std::abs(low_mm) + std::abs(high_mm) + laid_mm);
  return std::abs(beyond_mm) <= rounding_mm ? 1 : 1 + beyond_mm / pitch_mm;
}

}  // namespace

ColumnShares::ColumnShares(const StockShape& stock, const DexelGrid& grid)
    : last_i_(grid.columns_x - 1), last_j_(grid.columns_y - 1) {
  const BoxStock box = stock_bounds(stock);
  const Vec3 lo = to_frame(grid.axis, box.min_mm), hi = to_frame(grid.axis, box.max_mm);
  last_x_ = last_share(lo.x, hi.x, grid.pitch_mm, grid.columns_x);
  last_y_ = last_share(lo.y, hi.y, grid.pitch_mm, grid.columns_y);
}

bool ColumnShares::compute_group(std::int32_t i, std::int32_t j,
                                 std::array<double, 8>& shares) const {
  std::array<double, 8> all{};
  bool whole = true;
  for (std::size_t c = 0; c < all.size(); ++c) {
    all[c] = of(i + static_cast<std::int32_t>(c), j);
    whole = whole && all[c] == 1;
  }
  if (!whole) shares = all;
  return !whole;
}

}  // namespace kerf
