// SPDX-License-Identifier: Apache-2.0
#include "server/verify/gouge_check.h"

#include <algorithm>
#include <utility>

namespace kerf {
namespace {

/// Cost of comparing a row of a tile, in 1/32 of a distance.
constexpr std::size_t kRowsOfDistance = 32;

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

GougeCheck::GougeCheck(const GougeReference& reference, DexelSnapshot before, DexelSnapshot after,
                       const std::vector<FieldTile>& cut)
    : before_(std::move(before)),
      after_(std::move(after)),
      columns_(*reference.part, reference.tolerance_mm) {
  for (const FieldTile& at : cut) {
    if (at.axis == RayAxis::kZ) tiles_.push_back(at.tile);
  }
  std::ranges::sort(tiles_);
  const auto repeated = std::ranges::unique(tiles_);
  tiles_.erase(repeated.begin(), repeated.end());
}

bool GougeCheck::advance(std::size_t distances) {
  const std::size_t rows = tiles_.size() * kTileSide;
  const std::size_t distances_end = columns_.distances() + distances;
  const std::size_t rows_end = next_row_ + distances * kRowsOfDistance;
  while (next_row_ < rows) {
    if (columns_.distances() >= distances_end || next_row_ >= rows_end) return false;
    measure_row(tiles_[next_row_ / kTileSide], static_cast<std::int32_t>(next_row_ % kTileSide));
    ++next_row_;
  }
  return true;
}

/// Most rows of a cut tile are unchanged, and most columns of the changed rows.
void GougeCheck::measure_row(TileIndex tile, std::int32_t row) {
  const DexelGrid& grid = after_.grid();
  const std::int32_t j = tile.y * kTileSide + row;
  const DexelTile* a = before_.tiles().find(tile);
  const DexelTile* b = after_.tiles().find(tile);
  if (j >= grid.columns_y || a == b) return;
  const bool both = a != nullptr && b != nullptr;
  const int first = row * kTileSide;
  if (both && is_same(*a, *b, first, first + kTileSide)) return;
  const std::int32_t i_end = std::min((tile.x + 1) * kTileSide, grid.columns_x);
  int column = first;
  for (std::int32_t i = tile.x * kTileSide; i < i_end; ++i, ++column) {
    if (both && is_same(*a, *b, column, column + 1)) continue;
    const auto found = columns_.gouge(before_, after_, i, j);
    if (!found || (deepest_ && found->depth_mm <= deepest_->depth_mm)) continue;
    deepest_ = {found->depth_mm, {grid.x_mm(i), grid.y_mm(j), found->z_mm}};
  }
}

}  // namespace kerf
