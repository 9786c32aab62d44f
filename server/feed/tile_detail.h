// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "kernel/dexel/dexel_grid.h"
#include "kernel/surface/tile_mesh.h"

namespace kerf {

/// Levels of detail of a tile: 0 is the mesh as it is, each further one is coarser.
inline constexpr int kDetailLevelMax = 3;

/// How far a coarser level may lie from the mesh, mm: 1/8, 1/2 and 2 pitches. On the borders that
/// is the greatest distance, within the tile what meshoptimizer estimates, a mean (README.md has
/// the measured ones).
double detail_error_mm(int level, double pitch_mm);

/// The four neighbours that a tile shares a border with, as they number TileDetail::side.
inline constexpr std::array<TileIndex, 4> kSides{TileIndex{-1, 0}, TileIndex{1, 0},
                                                 TileIndex{0, -1}, TileIndex{0, 1}};

/// A tile's level, and that of each border: both tiles there must draw the same one, so it is the
/// finer of their two levels.
struct TileDetail {
  std::uint8_t level = 0;
  std::array<std::uint8_t, 4> side{};  ///< at most `level`
  friend bool operator==(const TileDetail&, const TileDetail&) = default;
};

/// The mesh with fewer triangles. Tiles meet without a crack whatever their levels are, as long as
/// they agree about each border (README.md has the proof). Deterministic.
TileMesh coarser_tile(const TileMesh& mesh, const DexelGrid& grid, const TileDetail& detail);

/// From where a viewer looks, and how small what it does not see is.
struct ViewerLook {
  Vec3 eye_mm;           ///< in the world
  double error_rad = 0;  ///< an error seen under this angle does not matter; 0: every error does
};

/// The level for a tile that has been shown at `shown` so far: the coarsest whose error is small
/// enough as seen from the eye. Gets coarser only with a quarter to spare, so that a camera at the
/// limit does not change levels back and forth.
int detail_level(const ViewerLook& look, const DexelGrid& grid, TileIndex tile, int shown);

}  // namespace kerf
