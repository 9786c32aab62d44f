// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "kernel/dexel/dexel.h"

namespace kerf {

struct DexelTile;

/// Some columns of one tile, for transfer from one copy of a block to another.
struct TileColumns {
  struct Column {
    std::int32_t place;  ///< within the tile, row-major
    std::uint32_t
        end;  ///< end of its elements in `dexels`; they begin at the previous column's end
  };
  std::vector<Column> columns;  ///< by ascending place, without duplicates
  std::vector<Dexel> dexels;    ///< of each column, sorted from the bottom up, disjoint, gaps > 0

  /// Returns the elements of a column, given its index in `columns`.
  std::span<const Dexel> of(std::size_t column) const {
    const std::size_t begin = column == 0 ? 0 : columns[column - 1].end;
    return std::span(dexels).subspan(begin, columns[column].end - begin);
  }
  /// Appends a column. `place` must be greater than that of the last one.
  void add(std::int32_t place, std::span<const Dexel> elements) {
    dexels.insert(dexels.end(), elements.begin(), elements.end());
    columns.push_back({place, static_cast<std::uint32_t>(dexels.size())});
  }
};

/// Intersects each of these columns with the tile's. The tile's other columns do not change.
/// Returns whether the tile changed. Stock only ever shrinks, so the intersection of two copies of
/// a block holds exactly the material that neither has lost, and copies converge whatever the order
/// and number of exchanges.
bool keep_common(DexelTile& tile, const TileColumns& other);

}  // namespace kerf
