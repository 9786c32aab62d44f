// SPDX-License-Identifier: Apache-2.0
#include "server/verify/changed_rows.h"

#include <algorithm>
#include <utility>

namespace kerf {
namespace {

/// Rows of a tile that are compared in the time of one distance.
constexpr std::size_t kRowsPerDistance = 32;

/// Whether columns of one row are certainly equal.
bool is_same(const DexelTile& a, const DexelTile& b, int first, int end) {
  const std::uint32_t mask = (end - first == kTileSide ? ~0U : (1U << (end - first)) - 1U)
                             << (first % kTileSide);
  const auto row = static_cast<std::size_t>(first / kTileSide);
  if (((a.split[row] | b.split[row]) & mask) != 0) return false;
  return std::equal(a.top.begin() + first, a.top.begin() + end, b.top.begin() + first) &&
         std::equal(a.bottom.begin() + first, a.bottom.begin() + end, b.bottom.begin() + first);
}

}  // namespace

ChangedRows::ChangedRows(DexelSnapshot before, DexelSnapshot after,
                         const std::vector<FieldTile>& cut)
    : before_(std::move(before)), after_(std::move(after)) {
  for (const FieldTile& at : cut) {
    if (at.axis == RayAxis::kZ) tiles_.push_back(at.tile);
  }
  std::ranges::sort(tiles_);
  const auto repeated = std::ranges::unique(tiles_);
  tiles_.erase(repeated.begin(), repeated.end());
}

bool ChangedRows::advance(std::size_t distances, const Measure& measure) {
  std::size_t rows_left = distances * kRowsPerDistance;
  while (next_ < tiles_.size() * kTileSide) {
    if (rows_left == 0) return false;
    rows_left -= std::min(rows_left, 1 + measure_next(measure) * kRowsPerDistance);
  }
  return true;
}

/// Measures the changed columns of the next row. Returns the number of distances computed.
std::size_t ChangedRows::measure_next(const Measure& measure) {
  const TileIndex tile = tiles_[next_ / kTileSide];
  const auto row = static_cast<std::int32_t>(next_ % kTileSide);
  ++next_;
  const DexelGrid& grid = after_.grid();
  const std::int32_t j = tile.y * kTileSide + row;
  const DexelTile* a = before_.tiles().find(tile);
  const DexelTile* b = after_.tiles().find(tile);
  if (j >= grid.columns_y || a == b) return 0;
  const bool both = a != nullptr && b != nullptr;
  const int first = row * kTileSide;
  if (both && is_same(*a, *b, first, first + kTileSide)) return 0;
  const std::int32_t i_end = std::min((tile.x + 1) * kTileSide, grid.columns_x);
  int column = first;
  std::size_t distances = 0;
  for (std::int32_t i = tile.x * kTileSide; i < i_end; ++i, ++column) {
    if (!both || !is_same(*a, *b, column, column + 1)) distances += measure(i, j);
  }
  return distances;
}

}  // namespace kerf
