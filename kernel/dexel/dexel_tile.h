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

/// Blocks of 8 x 8 columns along one side of a tile, and in it: what a sweep is compared with
/// before it is evaluated.
inline constexpr int kTileBlocksAcross = kTileSide / 8;
inline constexpr int kTileBlocks = kTileBlocksAcross * kTileBlocksAcross;

/// A column as a tile stores it, to be read where it stands.
struct ColumnView {
  std::span<const Dexel> lower;           ///< from the bottom up
  Dexel topmost;                          ///< bottom == top: the column is empty
  std::span<const EndCodes> lower_codes;  ///< as many as `lower`, or none where none are kept
  EndCodes topmost_codes;
};

/// The columns of one touched tile, row-major. Most columns hold one solid element or none, so the
/// topmost element of each stands in two flat arrays that the cutting loop reads like a height map;
/// what lies below it, in the columns that have been split, is kept in `lower`.
struct DexelTile {
  alignas(64) std::array<std::int32_t, kTileColumns> bottom;
  alignas(64) std::array<std::int32_t, kTileColumns> top;  ///< top == bottom: the column is empty
  std::array<std::uint32_t, kTileSide>
      split{};  ///< per row, bit i: column i has elements in `lower`
  LowerElements<Dexel> lower;
  /// Normals of the ends of the topmost elements, per column, and of those in `lower`; empty in a
  /// field that keeps none. An element that is empty has codes of no meaning.
  std::vector<EndCodes> topmost_codes;
  LowerElements<EndCodes> lower_codes;
  /// Of each 8 x 8 columns, row-major: no element reaches higher.
  std::array<std::int32_t, kTileBlocks> block_top{};
  std::uint64_t era = 0;  ///< the field's era in which the tile was made

  bool is_split(int column) const {
    return (split[std::size_t(column / kTileSide)] >> (column % kTileSide)) & 1;
  }
  /// The elements of a column, from the bottom up.
  void read(int column, std::vector<Dexel>& out) const;
  ColumnView view(int column) const;
  /// Replaces a column's elements (sorted, disjoint). Ends that stay where they are keep their
  /// normals.
  void write(int column, std::span<const Dexel> dexels);
  /// Brings the bounds of the tile up to date; whoever changes `top` calls it before anyone else
  /// looks.
  void update_bounds();
  /// The same for one block.
  void update_bounds(int block);
  bool keeps_normals() const { return !topmost_codes.empty(); }
  /// Of a split column of a tile that keeps normals: where the normal of the top (bottom) end at
  /// that depth is kept; null if no element below the topmost has one there.
  NormalCode* lower_top_code(int column, std::int32_t depth);
  NormalCode* lower_bottom_code(int column, std::int32_t depth);
  /// Memory, with what hangs on it.
  std::size_t bytes() const {
    return sizeof *this + lower.bytes() + lower_codes.bytes() +
           topmost_codes.capacity() * sizeof(EndCodes);
  }

 private:
  void carry_codes(int column, std::span<const Dexel> dexels);
};

}  // namespace kerf
