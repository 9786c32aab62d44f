#pragma once

#include <cstdint>
#include <vector>

#include "kernel/dexel/tile_index.h"

namespace kerf {

/// What a cut took away from one element each of eight neighbouring columns of a row: columns i …
/// i + 7 of row j, i a multiple of eight; depths in quanta (Δx_i of paper Eq. 18 is top − bottom),
/// bottom == top where nothing was taken. The unit that vector registers hold.
struct RemovedGroup {
  static constexpr int kLanes = 8;
  std::int32_t i, j;
  std::int32_t bottom[kLanes], top[kLanes];
};

/// What one sub-motion removed. Groups come in tile order, block by block within a tile: sums over
/// them run in one order whatever the machine. Columns of which several elements were cut stand in
/// several groups.
struct Removal {
  std::vector<RemovedGroup> groups;
  std::int64_t quanta = 0;  ///< total length of what was removed
  std::vector<TileIndex> changed_tiles;

  /// How many elements were shortened, split or taken whole.
  std::int64_t elements() const {
    std::int64_t count = 0;
    for (const RemovedGroup& g : groups) {
      for (int c = 0; c < RemovedGroup::kLanes; ++c) count += g.bottom[c] < g.top[c] ? 1 : 0;
    }
    return count;
  }

  void clear() {
    groups.clear();
    quanta = 0;
    changed_tiles.clear();
  }
};

}  // namespace kerf
