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

/// Lower bounds of a piece's sweep in eight rows.
struct RowBounds {
  Lanes lowest_mm = Lanes(std::numeric_limits<double>::infinity());
  LeftOut left_out = {};
  unsigned reached = 0;  ///< rows (bit r: row r) in which there is stock above the bound

  /// Returns the rows in which the piece may change the stock.
  unsigned changed() const { return reached & ~left_out.gone; }
};

/// The bounds of piece k; none if there is no such piece.
RowBounds bounds_of(const std::vector<SweptPiece>& pieces, std::size_t k, const Discs& discs,
                    const Lanes& stock_below) {
  RowBounds bounds;
  if (k >= pieces.size()) return bounds;
  const auto bound = [&](const auto& s) { return s.lower_bound(discs, bounds.lowest_mm); };
  bounds.left_out = std::visit(bound, pieces[k]);
  bounds.reached = lanes_below(bounds.lowest_mm, stock_below);
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
  const unsigned rows = (1U << in_grid) - 1;
  bool has_stock = false;  // place_stock has been called
  RowBounds below, bounds = bounds_of(swept.pieces, 0, discs, matters_below);
  for (std::size_t k = 0; k < swept.pieces.size(); ++k) {
    const RowBounds above = bounds_of(swept.pieces, k + 1, discs, matters_below);
    block.lowest_mm = bounds.lowest_mm;
    block.below_is_swept = ~below.left_out.behind;
    block.above_is_swept = ~above.left_out.behind;
    // What a piece has lost already is joined to what a neighbor removes now.
    block.rows =
        bounds.reached & (~bounds.left_out.gone | below.changed() | above.changed()) & rows;
    block.drop_closed_rows();
    block.raised_rows = 0;
    if (block.rows != 0 && swept.above[k].covers_any()) swept.above[k].find_covered(block);
    if (block.rows != 0) {
      if (!has_stock && std::holds_alternative<TurningSweep>(swept.pieces[k])) {
        place_stock(grid, stored, row * kTileSide + column, block);
        has_stock = true;
      }
      std::visit([&](const auto& s) { s.evaluate(block); }, swept.pieces[k]);
    }
    below = bounds;
    bounds = above;
  }
}

}  // namespace kerf
