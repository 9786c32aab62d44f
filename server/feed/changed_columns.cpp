// SPDX-License-Identifier: Apache-2.0
#include "server/feed/changed_columns.h"

#include <algorithm>
#include <optional>

namespace kerf {
namespace {

bool is_same(const DexelTile& a, const DexelTile& b, int column) {
  const auto n = static_cast<std::size_t>(column);
  if (a.bottom[n] != b.bottom[n] || a.top[n] != b.top[n]) return false;
  if (a.keeps_normals() != b.keeps_normals()) return false;
  if (a.keeps_normals() && a.topmost_codes[n] != b.topmost_codes[n]) return false;
  if (!a.is_split(column) && !b.is_split(column)) return true;
  const ColumnView of_a = a.view(column), of_b = b.view(column);
  return std::ranges::equal(of_a.lower, of_b.lower) &&
         std::ranges::equal(of_a.lower_codes, of_b.lower_codes);
}

std::optional<ChangedColumns> difference(const DexelTile& a, const DexelTile& b, TileIndex tile) {
  ChangedColumns found{tile, kTileSide, kTileSide, 0, 0};
  for (std::int32_t y = 0; y < kTileSide; ++y) {
    for (std::int32_t x = 0; x < kTileSide; ++x) {
      if (is_same(a, b, y * kTileSide + x)) continue;
      found.begin_x = std::min(found.begin_x, x);
      found.begin_y = std::min(found.begin_y, y);
      found.end_x = std::max(found.end_x, x + 1);
      found.end_y = y + 1;
    }
  }
  return found.end_y > 0 ? std::optional(found) : std::nullopt;
}

}  // namespace

std::vector<ChangedColumns> changed_columns(const SolidSnapshot& before, const SolidSnapshot& after,
                                            std::span<const TileIndex> tiles) {
  std::vector<ChangedColumns> changed;
  changed.reserve(tiles.size());
  for (const TileIndex tile : tiles) {
    const DexelTile* a = before.fields.front().tiles().find(tile);
    const DexelTile* b = after.fields.front().tiles().find(tile);
    if (after.fields.size() > 1 || a == nullptr || b == nullptr) {
      changed.push_back({tile});
    } else if (const auto columns = difference(*a, *b, tile)) {
      changed.push_back(*columns);
    }
  }
  return changed;
}

}  // namespace kerf
