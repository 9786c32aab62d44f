// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <expected>
#include <span>
#include <string_view>
#include <vector>

#include "kernel/dexel/dexel_tile.h"
#include "kernel/dexel/tile_columns.h"

namespace kerf {

/// Encodes the columns of a tile for a stock frame (server/wire/README.md, "Stock"): all columns,
/// or, if the receiver has the tile in the state `before`, those that have changed since. Empty if
/// none has changed.
std::vector<std::byte> encode_columns(const DexelTile& tile, const DexelTile* before);

/// Decodes columns. Rejects columns whose elements are not sorted and disjoint with gaps between
/// them, or not below 2^30 quanta.
std::expected<TileColumns, std::string_view> decode_columns(std::span<const std::byte> bytes);

}  // namespace kerf
