// SPDX-License-Identifier: Apache-2.0
#include "kernel/cut/swept_block.h"

#include <algorithm>
#include <cstddef>
#include <span>
#include <variant>
#include <vector>

#include "kernel/cut/block_places.h"

namespace kerf {
namespace {

/// Finds the bounds of all pieces in the rows of a block. Returns the rows that may change.
unsigned find_bounds(const SweptTool& swept, const Discs& discs, const Lanes& stock_below,
                     std::vector<PieceBounds>& bounds) {
  ToolReach reach;
  bounds.clear();
  for (std::size_t k = 0; k < swept.pieces.size(); ++k) {
    PieceBounds& b = bounds.emplace_back();
    const auto bound = [&](const auto& s) { return s.lower_bound(discs, b.lowest_mm); };
    b.left_out = std::visit(bound, swept.pieces[k]);
    b.reached = lanes_below(b.lowest_mm, stock_below);
    reach.add(b, b.reached);
  }
  return reach.discs();
}

/// Returns those of `rows` in which a piece must be evaluated. An interval that a piece has already
/// lost is joined to that of a neighbor.
unsigned swept_rows(std::span<const PieceBounds> bounds, std::size_t piece, unsigned rows) {
  const PieceBounds& b = bounds[piece];
  unsigned swept = ~b.left_out.gone;
  if (piece > 0) swept |= bounds[piece - 1].changed();
  if (piece + 1 < bounds.size()) swept |= bounds[piece + 1].changed();
  return b.reached & swept & rows;
}

}  // namespace

unsigned bound_block(const SweptTool& swept, const DexelGrid& grid, const DexelTile* stored,
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
  return find_bounds(swept, discs, matters_below, block.bounds) & ((1U << in_grid) - 1);
}

const BallSweep* ball_above(const SweptTool& swept, const ColumnBlock& block, unsigned rows) {
  const BallSweep* ball = nullptr;
  for (std::size_t k = 0; k < swept.pieces.size(); ++k) {
    if (swept_rows(block.bounds, k, rows) == 0) continue;
    const auto* other = std::get_if<BallSweep>(&swept.pieces[k]);
    if (other == nullptr || ball != nullptr) return nullptr;
    ball = other;
  }
  return ball != nullptr && ball->stays_above(block.top_mm) ? ball : nullptr;
}

void sweep_rows(const SweptTool& swept, const DexelGrid& grid, const DexelTile* stored,
                std::int32_t i, std::int32_t j, unsigned rows, ColumnBlock& block) {
  const int first = j % kTileSide * kTileSide + i % kTileSide;
  unsigned with_stock = 0;  // rows for which place_stock has been called
  const PieceBounds none;
  for (std::size_t k = 0; k < swept.pieces.size(); ++k) {
    const PieceBounds& below = k > 0 ? block.bounds[k - 1] : none;
    const PieceBounds& above = k + 1 < swept.pieces.size() ? block.bounds[k + 1] : none;
    block.lowest_mm = block.bounds[k].lowest_mm;
    block.below_is_swept = ~below.left_out.behind;
    block.above_is_swept = ~above.left_out.behind;
    block.rows = swept_rows(block.bounds, k, rows);
    block.drop_closed_rows();
    block.raised_rows = 0;
    if (block.rows != 0 && swept.above[k].covers_any()) swept.above[k].find_covered(block);
    if (block.rows == 0) continue;
    if (const auto* turning = std::get_if<TurningSweep>(&swept.pieces[k])) {
      const RowBits known = turning->add_simple_rows(block);
      const unsigned placed = block.rows & ~with_stock;
      if (placed != 0) place_stock(grid, stored, first, placed, block);
      with_stock |= placed;
      turning->evaluate(known, block);
    } else {
      std::visit([&](const auto& s) { s.evaluate(block); }, swept.pieces[k]);
    }
  }
}

void sweep_block(const SweptTool& swept, const DexelGrid& grid, const DexelTile* stored,
                 std::int32_t i, std::int32_t j, ColumnBlock& block) {
  const unsigned rows = bound_block(swept, grid, stored, i, j, block);
  if (rows != 0) sweep_rows(swept, grid, stored, i, j, rows, block);
}

}  // namespace kerf
