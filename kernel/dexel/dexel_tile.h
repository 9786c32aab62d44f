#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "kernel/dexel/dexel.h"
#include "kernel/dexel/lower_elements.h"
#include "kernel/dexel/tile_index.h"

namespace kerf {

/// Blocks of 8 x 8 columns along one side of a tile, and in it: what a sweep is compared with
/// before it is evaluated.
inline constexpr int kTileBlocksAcross = kTileSide / 8;
inline constexpr int kTileBlocks = kTileBlocksAcross * kTileBlocksAcross;

/// The columns of one touched tile, row-major. Most columns hold one solid element or none, so the
/// topmost element of each stands in two flat arrays that the cutting loop reads like a height map;
/// what lies below it, in the columns that have been split, is kept in `lower`.
struct DexelTile {
  alignas(64) std::array<std::int32_t, kTileColumns> bottom;
  alignas(64) std::array<std::int32_t, kTileColumns> top;  ///< top == bottom: the column is empty
  std::array<std::uint32_t, kTileSide>
      split{};  ///< per row, bit i: column i has elements in `lower`
  LowerElements lower;
  /// Of each 8 x 8 columns, row-major: no element reaches higher.
  std::array<std::int32_t, kTileBlocks> block_top{};
  std::uint64_t era = 0;  ///< the field's era in which the tile was made

  bool is_split(int column) const {
    return (split[std::size_t(column / kTileSide)] >> (column % kTileSide)) & 1;
  }
  /// The elements of a column, from the bottom up.
  void read(int column, std::vector<Dexel>& out) const;
  /// Replaces a column's elements (sorted, disjoint).
  void write(int column, std::span<const Dexel> dexels);
  /// Brings the bounds of the tile up to date; whoever changes `top` calls it before anyone else
  /// looks.
  void update_bounds();
  /// The same for one block.
  void update_bounds(int block);
  /// Greatest top in each of the eight rows of a block.
  void row_tops(int block, std::int32_t* tops) const;
  /// Memory, with what hangs on it.
  std::size_t bytes() const { return sizeof *this + lower.bytes(); }
};

}  // namespace kerf
