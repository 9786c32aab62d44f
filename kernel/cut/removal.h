// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "kernel/dexel/column_shares.h"
#include "kernel/dexel/tile_index.h"

namespace kerf {

/// The elements that a cut removed from eight neighboring columns of a row, one per column: columns
/// i … i + 7 of row j, i a multiple of eight. Depths in quanta. top − bottom is Δx_i of paper Eq.
/// 18, and 0 where nothing was removed. Eight columns fill the SIMD lanes.
struct RemovedGroup {
  static constexpr int kLanes = 8;
  std::int32_t i, j;
  std::int32_t bottom[kLanes], top[kLanes];
};

/// Returns the tile of a group.
inline TileIndex tile_of(const RemovedGroup& group) {
  return {group.i / kTileSide, group.j / kTileSide};
}

/// Returns the number of elements in groups.
inline std::int64_t elements_of(std::span<const RemovedGroup> groups) {
  std::int64_t count = 0;
  for (const RemovedGroup& g : groups) {
    for (int c = 0; c < RemovedGroup::kLanes; ++c) count += g.bottom[c] < g.top[c] ? 1 : 0;
  }
  return count;
}

/// Returns the excess of the elements' weighted length over their length in one tile, in quanta:
/// the sum of length x (share - 1). 0 if all their columns are whole.
double border_quanta(std::span<const RemovedGroup> groups, const ColumnShares& shares);

/// The elements removed from a sequence of tiles. Within a tile the groups are ordered by block.
/// Columns in which several elements were cut appear in several groups.
struct RemovedPart {
  struct Tile {
    TileIndex index;
    std::size_t end;  ///< end of its groups; they begin at the previous tile's end
  };
  std::vector<RemovedGroup> groups;
  std::vector<Tile> tiles;  ///< the tiles that changed
  std::int64_t quanta = 0;  ///< total length of the removed elements

  /// Returns the groups of a tile, given its index in `tiles`.
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

/// The elements that one sub-motion removed from a field, in parts of whole tiles, in tile order.
/// The number of parts depends on the number of threads; their concatenation does not. Sums are
/// computed tile by tile, so their order is the same on every machine. Reuses its memory.
class Removal {
 public:
  std::span<const RemovedPart> parts() const { return {parts_.data(), used_}; }
  std::span<RemovedPart> parts() { return {parts_.data(), used_}; }
  /// Returns the total length of the removed elements, in quanta.
  std::int64_t quanta() const {
    std::int64_t sum = 0;
    for (const RemovedPart& part : parts()) sum += part.quanta;
    return sum;
  }
  /// Returns the number of elements that were shortened, split or removed entirely.
  std::int64_t elements() const {
    std::int64_t count = 0;
    for (const RemovedPart& part : parts()) count += elements_of(part.groups);
    return count;
  }
  /// Returns the sum of border_quanta of the tiles.
  double border(const ColumnShares& shares) const {
    double sum = 0;
    for (const RemovedPart& part : parts()) {
      for (std::size_t t = 0; t < part.tiles.size(); ++t) sum += border_quanta(part.of(t), shares);
    }
    return sum;
  }

  /// Clears the removal and returns this many empty parts to fill.
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
