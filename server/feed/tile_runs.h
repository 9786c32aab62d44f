// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "server/feed/tile_encoding.h"

namespace kerf {

/// A rectangle of tiles that differ only in position: tile [x + i, y + j] is the first one moved by
/// (i, j) tile sides, for i < columns and j < rows. So one node of a frame can represent all.
struct TileRun {
  std::size_t first = 0;  ///< number of the tile [x, y], which has the lowest x and y
  std::int32_t columns = 1, rows = 1;
};

/// Divides tiles into such rectangles, each tile into one: from the first tile on, to the right as
/// far as possible and then up. With `same_digests` the tiles of a rectangle have equal digests
/// too. Deterministic; n log n map look-ups for n tiles.
std::vector<TileRun> runs_of(std::span<const EncodedTile* const> tiles,
                             const MeshQuantization& quantization, bool same_digests = false);

}  // namespace kerf
