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

/// What a tile holds, as the columns of a stock frame (server/wire/README.md, "stock"): every
/// column, or, where the receiver was sent the tile as it was `before`, those that have changed
/// since. Empty if none has.
std::vector<std::byte> encode_columns(const DexelTile& tile, const DexelTile* before);

/// Reads them back; the error says what is wrong with them. Accepts nothing that is no column:
/// elements are sorted and disjoint, with gaps between them, and lie below 2^30 quanta.
std::expected<TileColumns, std::string_view> decode_columns(std::span<const std::byte> bytes);

}  // namespace kerf
