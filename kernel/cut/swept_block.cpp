// SPDX-License-Identifier: Apache-2.0
#include "kernel/cut/swept_block.h"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <variant>
#include <vector>

#include "kernel/cut/block_places.h"

namespace kerf {
namespace {

/// Lower bounds of a piece's sweep in eight rows; bit r of `behind`: row r is left out because it
/// is behind the piece.
struct RowBounds {
  Lanes lowest_mm;
  unsigned behind = 0;
};

RowBounds bounds_of(const std::vector<SweptPiece>& pieces, std::size_t k, const Discs& discs) {
  RowBounds bounds{Lanes(std::numeric_limits<double>::infinity())};
  if (k >= pieces.size()) return bounds;
  const auto bound = [&](const auto& s) { return s.lower_bound(discs, bounds.lowest_mm); };
  bounds.behind = std::visit(bound, pieces[k]);
  return bounds;
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
  block.grid_top_mm = grid.z_mm(grid.height_quanta);
  block.join_mm = swept.join_mm;
  block.clear();
  // A piece just above the stock may close a gap to one that reaches into it.
  const Lanes matters_below =
      swept.pieces.size() > 1 ? reached_below + swept.join_mm : reached_below;
  unsigned behind_below = 0;
  RowBounds bounds = bounds_of(swept.pieces, 0, discs);
  for (std::size_t k = 0; k < swept.pieces.size(); ++k) {
    const RowBounds above = bounds_of(swept.pieces, k + 1, discs);
    block.lowest_mm = bounds.lowest_mm;
    block.below_is_swept = ~behind_below;
    block.above_is_swept = ~above.behind;
    block.rows = lanes_below(block.lowest_mm, matters_below) & ((1U << in_grid) - 1);
    block.drop_closed_rows();
    block.raised_rows = 0;
    if (block.rows != 0 && swept.above[k].covers_any()) swept.above[k].find_covered(block);
    if (block.rows != 0) std::visit([&](const auto& s) { s.evaluate(block); }, swept.pieces[k]);
    behind_below = bounds.behind;
    bounds = above;
  }
}

}  // namespace kerf
