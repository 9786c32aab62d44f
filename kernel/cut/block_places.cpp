// SPDX-License-Identifier: Apache-2.0
#include "kernel/cut/block_places.h"

#include <bit>
#include <cstddef>
#include <cstring>

#include "kernel/math/int_lanes.h"

namespace kerf {
namespace {

constexpr double kSqrt2 = 1.4142135623730952;
/// Distance from the first column of a block or a tile to its center, in pitches.
constexpr double kBlockMiddle = (kBlockSide - 1) / 2.0, kTileMiddle = (kTileSide - 1) / 2.0;

/// A lower end is rounded to the nearest quantum, so one that is less than half a quantum below the
/// top removes nothing. The remainder of the half allows for the rounding of bounds.
constexpr double kNothingBelowQuanta = 0.4375;

KERF_INLINE Lanes below_which(const DexelGrid& grid, Lanes tops) {
  return grid.origin_mm.z + (tops - kNothingBelowQuanta) * grid.z_quantum_mm;
}
KERF_INLINE Lanes x_of(const DexelGrid& grid, Lanes i) {
  return grid.origin_mm.x + (i + 0.5) * grid.pitch_mm;
}
KERF_INLINE Lanes y_of(const DexelGrid& grid, Lanes j) {
  return grid.origin_mm.y + (j + 0.5) * grid.pitch_mm;
}

KERF_INLINE void tiles_in_lanes(const DexelGrid& grid, TileIndex first, Discs& discs,
                                Lanes& reached_below) {
  const double middle = kTileMiddle * grid.pitch_mm;
  const Lanes i = double(first.x) * kTileSide + lane_numbers() * kTileSide;
  discs.x_mm = x_of(grid, i) + middle;
  discs.y_mm = Lanes(grid.y_mm(first.y * kTileSide) + middle);
  discs.reach_mm = kSqrt2 * middle;
  reached_below = below_which(grid, Lanes(grid.height_quanta));
}

KERF_INLINE void blocks_in_lanes(const DexelGrid& grid, TileIndex tile, int half,
                                 const std::int32_t* tops, Discs& discs, Lanes& reached_below) {
  static_assert(kTileBlocksAcross == 4 && kTileBlocks == 2 * kLanes);
  const double middle = kBlockMiddle * grid.pitch_mm;
  const Lanes across{HalfLanes{0, 8, 16, 24}, HalfLanes{0, 8, 16, 24}};
  const Lanes up{HalfLanes{0, 0, 0, 0}, HalfLanes{8, 8, 8, 8}};
  discs.x_mm = x_of(grid, double(tile.x) * kTileSide + across) + middle;
  discs.y_mm = y_of(grid, double(tile.y) * kTileSide + half * 16.0 + up) + middle;
  discs.reach_mm = kSqrt2 * middle;
  const Lanes top = tops != nullptr ? to_lanes(load_ints(tops + std::ptrdiff_t(half) * kLanes))
                                    : Lanes(grid.height_quanta);
  reached_below = below_which(grid, top);
}

/// Returns the greatest depth of each of eight rows, by a transposition and a reduction in three
/// steps.
KERF_INLINE IntLanes highest_of_rows(const std::int32_t* tops) {
  IntLanes two[4], four[2];
  for (std::ptrdiff_t k = 0; k < 4; ++k) {
    const IntLanes a = load_ints(tops + 2 * k * kTileSide),
                   b = load_ints(tops + (2 * k + 1) * kTileSide);
    two[k] = greater(__builtin_shufflevector(a, b, 0, 8, 1, 9, 4, 12, 5, 13),
                     __builtin_shufflevector(a, b, 2, 10, 3, 11, 6, 14, 7, 15));
  }
  for (std::ptrdiff_t k = 0; k < 2; ++k) {
    const IntLanes a = two[2 * k], b = two[2 * k + 1];
    four[k] = greater(__builtin_shufflevector(a, b, 0, 1, 8, 9, 4, 5, 12, 13),
                      __builtin_shufflevector(a, b, 2, 3, 10, 11, 6, 7, 14, 15));
  }
  return greater(__builtin_shufflevector(four[0], four[1], 0, 1, 2, 3, 8, 9, 10, 11),
                 __builtin_shufflevector(four[0], four[1], 4, 5, 6, 7, 12, 13, 14, 15));
}

KERF_INLINE void rows_in_lanes(const DexelGrid& grid, std::int32_t i, std::int32_t j,
                               const std::int32_t* tops, ColumnBlock& block, Discs& discs,
                               Lanes& reached_below) {
  block.x_mm = x_of(grid, double(i) + lane_numbers());
  discs.x_mm = Lanes(grid.x_mm(i) + kBlockMiddle * grid.pitch_mm);
  discs.y_mm = y_of(grid, double(j) + lane_numbers());
  std::memcpy(block.y_mm, &discs.y_mm, sizeof block.y_mm);
  discs.reach_mm = kBlockMiddle * grid.pitch_mm;
  const Lanes top = tops != nullptr ? to_lanes(highest_of_rows(tops)) : Lanes(grid.height_quanta);
  reached_below = below_which(grid, top);
}

KERF_INLINE void stock_in_lanes(const DexelGrid& grid, const DexelTile& tile, int first,
                                unsigned rows, ColumnBlock& block) {
  for (unsigned rest = rows; rest != 0; rest &= rest - 1) {
    const auto row = std::size_t(std::countr_zero(rest));
    const int column = first + static_cast<int>(row) * kTileSide;
    const auto at = std::size_t(column);
    IntLanes bottom = load_ints(&tile.bottom[at]);
    const unsigned split = tile.split[at / kTileSide] >> (at % kTileSide) & 0xFFU;
    for (unsigned left = split; left != 0; left &= left - 1) {
      const int k = std::countr_zero(left);
      bottom[k] = tile.lower.of(column + k).front().bottom;
    }
    const auto height = [&](IntLanes depth) __attribute__((always_inline)) {
      return grid.origin_mm.z + to_lanes(depth) * grid.z_quantum_mm;
    };
    block.stock_lo_mm[row] = height(bottom);
    block.stock_hi_mm[row] = height(load_ints(&tile.top[at]));
  }
}

KERF_FOR_EACH_TARGET(void, tiles,
                     (const DexelGrid& grid, TileIndex first, Discs& discs, Lanes& reached_below),
                     (grid, first, discs, reached_below))
KERF_FOR_EACH_TARGET(void, blocks,
                     (const DexelGrid& grid, TileIndex tile, int half, const std::int32_t* tops,
                      Discs& discs, Lanes& reached_below),
                     (grid, tile, half, tops, discs, reached_below))
KERF_FOR_EACH_TARGET(void, rows,
                     (const DexelGrid& grid, std::int32_t i, std::int32_t j,
                      const std::int32_t* tops, ColumnBlock& block, Discs& discs,
                      Lanes& reached_below),
                     (grid, i, j, tops, block, discs, reached_below))

KERF_FOR_EACH_TARGET(void, stock,
                     (const DexelGrid& grid, const DexelTile& tile, int first, unsigned rows,
                      ColumnBlock& block),
                     (grid, tile, first, rows, block))

}  // namespace

void place_tiles(const DexelGrid& grid, TileIndex first, Discs& discs, Lanes& reached_below) {
  tiles(grid, first, discs, reached_below);
}

void place_blocks(const DexelGrid& grid, TileIndex tile, int half, const std::int32_t* tops,
                  Discs& discs, Lanes& reached_below) {
  blocks(grid, tile, half, tops, discs, reached_below);
}

void place_rows(const DexelGrid& grid, std::int32_t i, std::int32_t j, const std::int32_t* tops,
                ColumnBlock& block, Discs& discs, Lanes& reached_below) {
  rows(grid, i, j, tops, block, discs, reached_below);
}

void place_stock(const DexelGrid& grid, const DexelTile* tile, int column, unsigned rows,
                 ColumnBlock& block) {
  if (tile != nullptr) return stock(grid, *tile, column, rows, block);
  block.stock_lo_mm.fill(Lanes(grid.z_mm(0)));
  block.stock_hi_mm.fill(Lanes(grid.z_mm(grid.height_quanta)));
}

}  // namespace kerf
