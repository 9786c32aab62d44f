// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "kernel/dexel/dexel_grid.h"
#include "kernel/surface/tile_mesh.h"

namespace kerf {

/// Coarsest level of detail of a tile. Level 0 is the exact mesh.
inline constexpr int kDetailLevelMax = 3;

/// Returns the error of a level, mm: 0, 1/8, 1/2 and 2 pitches. On the borders it is the maximum
/// distance to the mesh. Inside the tile it is meshoptimizer's estimate, a mean
/// (tests/bench/results/server.md lists measured distances).
double detail_error_mm(int level, double pitch_mm);

/// Offsets of the four neighbors of a tile, in the order of TileDetail::side.
inline constexpr std::array<TileIndex, 4> kSides{TileIndex{-1, 0}, TileIndex{1, 0},
                                                 TileIndex{0, -1}, TileIndex{0, 1}};

/// The level of a tile and of each of its borders. A border has the finer level of its two tiles,
/// so that both produce the same edges.
struct TileDetail {
  std::uint8_t level = 0;
  std::array<std::uint8_t, 4> side{};  ///< at most `level`
  friend bool operator==(const TileDetail&, const TileDetail&) = default;
};

/// Returns the mesh simplified to `detail`. Neighboring tiles meet without cracks at any
/// combination of levels if they have the same level on their common border (README.md has the
/// proof). Deterministic.
TileMesh coarser_tile(const TileMesh& mesh, const DexelGrid& grid, const TileDetail& detail);

/// The viewpoint of a viewer and its angular tolerance; the contents of a `look` message.
struct ViewerLook {
  Vec3 eye_mm;           ///< world coordinates
  double error_rad = 0;  ///< errors seen under a smaller angle are allowed; 0: exact tiles
};

/// Returns the coarsest level whose error `look` allows. A level coarser than `current` requires a
/// margin of a quarter, so that a camera at the limit does not toggle between levels.
int detail_level(const ViewerLook& look, const DexelGrid& grid, TileIndex tile, int current);

}  // namespace kerf
