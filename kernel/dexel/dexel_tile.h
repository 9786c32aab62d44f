#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "kernel/dexel/dexel_snapshot.h"
#include "kernel/dexel/tile_index.h"

namespace kerf {

inline constexpr int kTileColumns = kTileSide * kTileSide;

/// The columns of one touched tile, row-major. Nearly every column holds one solid element or none,
/// so the topmost element of each stands in two flat arrays that the cutting loop reads like a
/// height map; what lies below it, in the few columns that have been split, is kept in `lower`.
struct DexelTile {
  struct Lower {
    std::uint16_t column;
    Dexel dexel;
    friend bool operator==(const Lower&, const Lower&) = default;
  };

  alignas(64) std::array<std::int32_t, kTileColumns> bottom;
  alignas(64) std::array<std::int32_t, kTileColumns> top;  ///< top == bottom: the column is empty
  std::array<std::uint32_t, kTileSide>
      split{};               ///< per row, bit i: column i has elements in `lower`
  std::vector<Lower> lower;  ///< by column, then from the bottom up
  std::int32_t top_max = 0;  ///< no element of the tile reaches higher
  std::uint64_t era = 0;     ///< the field's era in which the tile was made

  bool is_split(int column) const {
    return (split[std::size_t(column / kTileSide)] >> (column % kTileSide)) & 1;
  }
  /// The elements of a column, from the bottom up.
  void read(int column, std::vector<Dexel>& out) const;
  /// Replaces a column's elements (sorted, disjoint).
  void write(int column, std::span<const Dexel> dexels);
};

}  // namespace kerf
