// SPDX-License-Identifier: Apache-2.0
#include "server/feed/column_digest.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "kernel/dexel/dexel_tile.h"
#include "kernel/math/hash.h"

namespace kerf {
namespace {

void add(Hash& hash, std::int32_t a, std::int32_t b) {
  hash.add(std::uint64_t(static_cast<std::uint32_t>(a)) << 32U | static_cast<std::uint32_t>(b));
}

struct Range {
  std::int32_t begin = 0, end = 0;
};

/// The columns of a tile along one axis.
Range columns_of(std::int32_t tile, std::int32_t columns) {
  return {tile * kTileSide, std::min((tile + 1) * kTileSide, columns)};
}

/// The depths of rays across the tile's columns; `columns` is their number in the block.
Range depths_of(const DexelGrid& grid, Range tile, std::int32_t columns) {
  const auto depth_of = [&](std::int32_t column) {
    return static_cast<std::int32_t>(std::floor(column * grid.pitch_mm / grid.z_quantum_mm));
  };
  // The last tile includes ends on the block's side.
  const bool is_last = tile.end == columns;
  return {depth_of(tile.begin), is_last ? grid.height_quanta + 1 : depth_of(tile.end)};
}

void add_columns(Hash& hash, const DexelSnapshot& field, Range x, Range y) {
  std::vector<Dexel> scratch;
  for (std::int32_t j = y.begin; j < y.end; ++j) {
    for (std::int32_t i = x.begin; i < x.end; ++i) {
      const auto column = field.column(i, j, scratch);
      hash.add(column.size());
      for (const Dexel& element : column) add(hash, element.bottom, element.top);
    }
  }
}

/// Adds the ends within `depths` of the rays through the columns x, y of a field.
void add_ends(Hash& hash, const DexelSnapshot& field, Range x, Range y, Range depths) {
  std::vector<Dexel> scratch;
  for (std::int32_t j = y.begin; j < y.end; ++j) {
    for (std::int32_t i = x.begin; i < x.end; ++i) {
      for (const Dexel& element : field.column(i, j, scratch)) {
        for (const std::int32_t depth : {element.bottom, element.top}) {
          if (depth < depths.begin || depth >= depths.end) continue;
          add(hash, i - x.begin, j - y.begin);
          add(hash, depth == element.top ? 1 : 0, depth - depths.begin);
        }
      }
    }
  }
}

}  // namespace

std::uint64_t column_digest(const SolidSnapshot& solid, TileIndex tile) {
  const DexelGrid& grid = solid.grid();
  const Range x = columns_of(tile.x, grid.columns_x), y = columns_of(tile.y, grid.columns_y);
  Hash hash;
  add_columns(hash, solid.fields[0], x, y);
  if (solid.fields.size() > 1) {
    // In their frames (RayAxis) rays along X are at (y, z), rays along Y at (z, x).
    const DexelSnapshot &along_x = solid.fields[1], &along_y = solid.fields[2];
    const Range x_heights{0, along_x.grid().columns_y}, y_heights{0, along_y.grid().columns_x};
    add_ends(hash, along_x, y, x_heights, depths_of(along_x.grid(), x, grid.columns_x));
    add_ends(hash, along_y, y_heights, x, depths_of(along_y.grid(), y, grid.columns_y));
  }
  return hash.value();
}

}  // namespace kerf
