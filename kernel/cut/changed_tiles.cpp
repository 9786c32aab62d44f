// SPDX-License-Identifier: Apache-2.0
#include "kernel/cut/changed_tiles.h"

#include <algorithm>
#include <limits>

namespace kerf {

RemovedDepths depths_of(std::span<const RemovedGroup> removed) {
  RemovedDepths depths{std::numeric_limits<std::int32_t>::max(), 0};
  for (const RemovedGroup& g : removed) {
    for (int c = 0; c < RemovedGroup::kLanes; ++c) {
      if (g.bottom[c] >= g.top[c]) continue;
      depths.bottom = std::min(depths.bottom, g.bottom[c]);
      depths.top = std::max(depths.top, g.top[c]);
    }
  }
  return depths;
}

void append_changed_tiles(const DexelGrid& grid, TileIndex at, const RemovedDepths& depths,
                          std::vector<TileIndex>& changed) {
  if (grid.axis == RayAxis::kZ) {
    changed.push_back(at);
    return;
  }
  const double tile_quanta = kTileSide * grid.pitch_mm / grid.z_quantum_mm;
  const auto first = static_cast<std::int32_t>(depths.bottom / tile_quanta);
  const auto last = static_cast<std::int32_t>(depths.top / tile_quanta);
  for (std::int32_t t = first; t <= last; ++t) {
    changed.push_back(grid.axis == RayAxis::kX ? TileIndex{t, at.x} : TileIndex{at.y, t});
  }
}

}  // namespace kerf
