// SPDX-License-Identifier: Apache-2.0
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

/// Number of blocks of 8 x 8 columns along one side of a tile, and in a tile. A sweep is compared
/// with the bounds of a block before it is evaluated there.
inline constexpr int kTileBlocksAcross = kTileSide / 8;
inline constexpr int kTileBlocks = kTileBlocksAcross * kTileBlocksAcross;

/// A view of a column as its tile stores it.
struct ColumnView {
  std::span<const Dexel> lower;           ///< from the bottom up
  Dexel topmost;                          ///< bottom == top if the column is empty
  std::span<const EndCodes> lower_codes;  ///< as many as `lower`; empty in a tile without normals
  EndCodes topmost_codes;
};

/// The columns of one touched tile, row-major. Most columns hold at most one element, so the
/// topmost element of each is stored in two flat arrays, which the cutting loop reads like a height
/// map. In split columns, the elements below it are stored in `lower`.
struct DexelTile {
  alignas(64) std::array<std::int32_t, kTileColumns> bottom;
  alignas(64) std::array<std::int32_t, kTileColumns> top;  ///< top == bottom if the column is empty
  std::array<std::uint32_t, kTileSide>
      split{};  ///< per row, bit i: column i has elements in `lower`
  LowerElements<Dexel> lower;
  /// Normal codes of the ends of the topmost elements, per column, and of the elements in `lower`.
  /// Empty in a field that keeps no normals. The codes of an empty element are meaningless.
  std::vector<EndCodes> topmost_codes;
  LowerElements<EndCodes> lower_codes;
  /// An upper bound of `top` over each block of 8 x 8 columns, row-major.
  std::array<std::int32_t, kTileBlocks> block_top{};
  std::uint64_t era = 0;  ///< the field's era in which the tile was created

  bool is_split(int column) const {
    return (split[std::size_t(column / kTileSide)] >> (column % kTileSide)) & 1;
  }
  /// Copies the elements of a column to `out`, from the bottom up.
  void read(int column, std::vector<Dexel>& out) const;
  ColumnView view(int column) const;
  /// Replaces a column's elements (sorted, disjoint). Ends that remain keep their normals.
  void write(int column, std::span<const Dexel> dexels);
  /// Recomputes block_top. Required after a change of `top`, before the tile is read elsewhere.
  void update_bounds();
  /// Recomputes block_top of one block.
  void update_bounds(int block);
  bool keeps_normals() const { return !topmost_codes.empty(); }
  /// Returns the normal code of the top (bottom) end at a depth among the lower elements of a split
  /// column, or null if none ends there. The tile must keep normals.
  NormalCode* lower_top_code(int column, std::int32_t depth);
  NormalCode* lower_bottom_code(int column, std::int32_t depth);
  /// Returns the bytes of the tile, including its heap memory.
  std::size_t bytes() const {
    return sizeof *this + lower.bytes() + lower_codes.bytes() +
           topmost_codes.capacity() * sizeof(EndCodes);
  }

 private:
  void carry_codes(int column, std::span<const Dexel> dexels);
};

}  // namespace kerf
