#pragma once

#include <cstdint>
#include <vector>

#include "kernel/dexel/tile_index.h"

namespace kerf {

/// One piece of a dexel that a cut took away: column (i, j), depths in quanta (Δx_i of paper Eq. 18
/// is top − bottom).
struct RemovedSegment {
  std::int32_t i, j;
  std::int32_t bottom, top;
};

/// What one sub-motion removed. Segments come in tile order, row-major within a tile: sums over
/// them run in one order whatever the machine.
struct Removal {
  std::vector<RemovedSegment> segments;
  std::int64_t quanta = 0;  ///< total length of the segments
  std::vector<TileIndex> changed_tiles;

  void clear() {
    segments.clear();
    quanta = 0;
    changed_tiles.clear();
  }
};

}  // namespace kerf
