// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <compare>
#include <cstdint>

namespace kerf {

/// Columns along one side of a tile, the unit of storage, meshing and transfer.
inline constexpr int kTileSide = 32;
inline constexpr int kTileColumns = kTileSide * kTileSide;

/// Names a tile of kTileSide x kTileSide columns, counted from the block's minimum corner.
struct TileIndex {
  std::int32_t x = 0, y = 0;
  friend constexpr auto operator<=>(const TileIndex&, const TileIndex&) = default;
};

}  // namespace kerf
