// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "kernel/dexel/dexel.h"

namespace kerf {

struct DexelTile;

/// Some columns of one tile, on their way from one copy of a block to another.
struct TileColumns {
  struct Column {
    std::int32_t place;  ///< within the tile, row-major
    std::uint32_t end;   ///< its elements end here in `dexels`, and begin where the one before ends
  };
  std::vector<Column> columns;  ///< by place, none twice
  std::vector<Dexel> dexels;    ///< of each column sorted from the bottom up, disjoint, gaps > 0

  /// The elements of a column, given its place in `columns`.
  std::span<const Dexel> of(std::size_t column) const {
    const std::size_t begin = column == 0 ? 0 : columns[column - 1].end;
    return std::span(dexels).subspan(begin, columns[column].end - begin);
  }
  /// Adds a column behind the others.
  void add(std::int32_t place, std::span<const Dexel> elements) {
    dexels.insert(dexels.end(), elements.begin(), elements.end());
    columns.push_back({place, static_cast<std::uint32_t>(dexels.size())});
  }
};

/// Reduces each of these columns of a tile to what both hold; the others stay. Stock only ever
/// shrinks, so what two copies of a block both still hold is what neither has lost: in whatever
/// order and however often copies are compared, they come to the same. True if the tile changed.
bool keep_common(DexelTile& tile, const TileColumns& other);

}  // namespace kerf
