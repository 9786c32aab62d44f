// SPDX-License-Identifier: Apache-2.0
#include "kernel/cut/swept_block.h"

#include <algorithm>
#include <limits>
#include <variant>

#include "kernel/cut/block_places.h"

namespace kerf {
namespace {

Lanes lower_bound(const SweptPiece& piece, const Discs& discs) {
  Lanes z = Lanes(std::numeric_limits<double>::infinity());
  std::visit([&](const auto& s) { s.lower_bound(discs, z); }, piece);
  return z;
}

}  // namespace

void sweep_block(const SweptTool& swept, const DexelGrid& grid, const DexelTile* stored,
                 std::int32_t i, std::int32_t j, ColumnBlock& block) {
  const int row = j % kTileSide, column = i % kTileSide;
  const int number = row / kBlockSide * kTileBlocksAcross + column / kBlockSide;
  const std::int32_t top =
      stored != nullptr ? stored->block_top[std::size_t(number)] : grid.height_quanta;
  const std::int32_t* tops =
      stored != nullptr ? &stored->top[std::size_t(row * kTileSide + column)] : nullptr;
  Discs discs;
  Lanes reached_below;
  place_rows(grid, i, j, tops, block, discs, reached_below);
  const std::int32_t in_grid = std::min(kBlockSide, grid.columns_y - j);
  block.top_mm = grid.z_mm(top);
  block.join_mm = swept.join_mm;
  block.clear();
  for (const SweptPiece& piece : swept.pieces) {
    block.lowest_mm = lower_bound(piece, discs);
    block.rows = lanes_below(block.lowest_mm, reached_below) & ((1U << in_grid) - 1);
    block.drop_closed_rows();
    if (block.rows != 0) std::visit([&](const auto& s) { s.evaluate(block); }, piece);
  }
}

}  // namespace kerf
