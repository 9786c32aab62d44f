// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "kernel/dexel/solid_snapshot.h"

namespace kerf {

/// The part of the surface that belongs to one tile. Tiles meet without cracks: vertices shared by
/// two tiles are equal to the bit in both. At a sharp crease a position is repeated, once with the
/// normal of each side.
struct TileMesh {
  TileIndex tile;
  std::vector<std::array<float, 3>>
      positions_mm;  ///< relative to the block's minimum corner (DexelGrid::origin_mm)
  std::vector<std::array<float, 3>> normals;  ///< unit, outward; one per position
  std::vector<std::uint32_t> indices;  ///< three per triangle, counter-clockwise seen from outside
  /// One per position: 1 where the surface is that of the untouched stock, 0 where it was cut. At
  /// the side of a cut in a block with one field, 1 may reach a pitch too far.
  std::vector<std::uint8_t> original = {};
};

/// Extracts the part of the surface that one tile of the field along Z owns, from the rays of all
/// fields in and around it. The sculpture must keep normals. The union over all tiles of a solid is
/// closed, 2-manifold, consistently oriented, and has no degenerate triangle. Equal snapshots give
/// equal bytes. Thread-safe: different tiles may be meshed concurrently.
TileMesh mesh_tile(const SolidSnapshot& solid, TileIndex tile);

class FaceCover;
/// As above, without the quadrangles of covered patches (face_cover.h). Time and memory do not grow
/// with the height of the walls in covered patches.
TileMesh mesh_tile(const SolidSnapshot& solid, TileIndex tile, const FaceCover& cover);

/// A range [begin, end) of the columns of a tile of the field along Z, which includes all columns
/// whose rays have changed.
struct ChangedColumns {
  TileIndex tile;
  std::int32_t begin_x = 0, begin_y = 0, end_x = kTileSide, end_y = kTileSide;
};

/// Returns the tiles whose mesh reads some of these columns: sorted, without duplicates, within the
/// grid.
std::vector<TileIndex> tiles_that_read(const DexelGrid& grid,
                                       std::span<const ChangedColumns> changed);

/// Returns the tiles whose mesh may change when `changed` tiles change: these and the neighbors
/// that read their columns. Sorted, without duplicates, within the grid.
std::vector<TileIndex> tiles_to_remesh(const DexelGrid& grid,
                                       const std::vector<TileIndex>& changed);

}  // namespace kerf
