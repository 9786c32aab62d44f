// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
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

/// What was removed from some tiles, one after the other. Groups come block by block within a tile;
/// columns of which several elements were cut stand in several groups.
struct RemovedPart {
  struct Tile {
    TileIndex index;
    std::size_t end;  ///< its groups end here, and begin where those of the tile before end
  };
  std::vector<RemovedGroup> groups;
  std::vector<Tile> tiles;  ///< those that changed
  std::int64_t quanta = 0;  ///< total length of what was removed

  /// The groups of a tile, given its place in `tiles`.
  std::span<const RemovedGroup> of(std::size_t tile) const {
    const std::size_t begin = tile == 0 ? 0 : tiles[tile - 1].end;
    return {groups.data() + begin, tiles[tile].end - begin};
  }
  void clear() {
    groups.clear();
    tiles.clear();
    quanta = 0;
  }
};

/// What one sub-motion removed from a field: parts of whole tiles, in tile order. In how many parts
/// it is found depends on the threads at hand; what the parts say one after the other does not, and
/// sums are taken tile by tile, so that they run in one order whatever the machine. Keeps its
/// memory from one use to the next.
class Removal {
 public:
  std::span<const RemovedPart> parts() const { return {parts_.data(), used_}; }
  /// Total length of what was removed.
  std::int64_t quanta() const {
    std::int64_t sum = 0;
    for (const RemovedPart& part : parts()) sum += part.quanta;
    return sum;
  }
  /// How many elements were shortened, split or taken whole.
  std::int64_t elements() const {
    std::int64_t count = 0;
    for (const RemovedPart& part : parts()) {
      for (const RemovedGroup& g : part.groups) {
        for (int c = 0; c < RemovedGroup::kLanes; ++c) count += g.bottom[c] < g.top[c] ? 1 : 0;
      }
    }
    return count;
  }

  /// Empties it and makes so many parts, to be filled.
  std::span<RemovedPart> start(std::size_t parts) {
    if (parts_.size() < parts) parts_.resize(parts);
    used_ = parts;
    for (RemovedPart& part : std::span(parts_).first(used_)) part.clear();
    return std::span(parts_).first(used_);
  }

 private:
  std::vector<RemovedPart> parts_;
  std::size_t used_ = 0;
};

}  // namespace kerf
