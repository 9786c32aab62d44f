// SPDX-License-Identifier: Apache-2.0
#include "kernel/dexel/tile_columns.h"

#include <algorithm>

#include "kernel/dexel/dexel_tile.h"

namespace kerf {
namespace {

/// Computes the intersection of two columns. Both are sorted, so one pass suffices.
void intersect(std::span<const Dexel> a, std::span<const Dexel> b, std::vector<Dexel>& out) {
  out.clear();
  for (std::size_t i = 0, j = 0; i < a.size() && j < b.size();) {
    const std::int32_t bottom = std::max(a[i].bottom, b[j].bottom);
    const std::int32_t top = std::min(a[i].top, b[j].top);
    if (bottom < top) out.push_back({bottom, top});
    (a[i].top < b[j].top ? i : j) += 1;
  }
}

}  // namespace

bool keep_common(DexelTile& tile, const TileColumns& other) {
  std::vector<Dexel> mine, common;
  bool changed = false;
  for (std::size_t n = 0; n < other.columns.size(); ++n) {
    const int place = other.columns[n].place;
    tile.read(place, mine);
    intersect(mine, other.of(n), common);
    if (common == mine) continue;
    tile.write(place, common);
    changed = true;
  }
  if (changed) tile.update_bounds();
  return changed;
}

}  // namespace kerf
