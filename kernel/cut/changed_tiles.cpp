// SPDX-License-Identifier: Apache-2.0
#include "kernel/cut/changed_tiles.h"

#include <algorithm>

namespace kerf {

void append_changed_tiles(const DexelGrid& grid, const Removal& removal,
                          std::vector<TileIndex>& changed) {
  const double tile_quanta = kTileSide * grid.pitch_mm / grid.z_quantum_mm;
  for (const RemovedPart& part : removal.parts()) {
    for (std::size_t n = 0; n < part.tiles.size(); ++n) {
      const TileIndex at = part.tiles[n].index;
      if (grid.axis == RayAxis::kZ) {
        changed.push_back(at);
        continue;
      }
      std::int32_t low = grid.height_quanta, high = 0;
      for (const RemovedGroup& g : part.of(n)) {
        for (int c = 0; c < RemovedGroup::kLanes; ++c) {
          if (g.bottom[c] >= g.top[c]) continue;
          low = std::min(low, g.bottom[c]);
          high = std::max(high, g.top[c]);
        }
      }
      const auto first = static_cast<std::int32_t>(low / tile_quanta);
      const auto last = static_cast<std::int32_t>(high / tile_quanta);
      for (std::int32_t t = first; t <= last; ++t) {
        const TileIndex tile = grid.axis == RayAxis::kX ? TileIndex{t, at.x} : TileIndex{at.y, t};
        changed.push_back(tile);
      }
    }
  }
}

}  // namespace kerf
