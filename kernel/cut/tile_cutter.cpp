// SPDX-License-Identifier: Apache-2.0
#include "kernel/cut/tile_cutter.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include "kernel/cut/lazy_normals.h"
#include "kernel/cut/lower_tops.h"
#include "kernel/cut/reach.h"
#include "kernel/cut/subtract_rows.h"
#include "kernel/cut/swept_block.h"
#include "kernel/dexel/dexel_tile.h"

namespace kerf {
namespace {

/// Number of lower elements up to which all of them are compared.
constexpr std::size_t kFewElements = 8;

/// Returns the number of elements, sorted from the bottom up, that end at or below a depth.
KERF_INLINE std::size_t count_below(std::span<const Dexel> elements, std::int32_t depth) {
  const auto is_below = [&](const Dexel& d) { return d.top <= depth; };
  if (elements.size() > kFewElements) {
    return std::size_t(std::ranges::partition_point(elements, is_below) - elements.begin());
  }
  return std::size_t(std::ranges::count_if(elements, is_below));
}

}  // namespace

void TileCutter::begin(DexelField& field, TileIndex tile) {
  field_ = &field;
  work_ = {tile, field.find(tile), field.editable(tile)};
}

void TileCutter::cut(const SweptTool& swept, NormalCode end_code, RemovedPart& removed) {
  const unsigned blocks = find_blocks(grid(), swept, work_.index, work_.stored);
  if (blocks == 0) return;
  swept_ = &swept;
  removed_ = &removed;
  const std::int64_t before = removed.quanta;
  for (unsigned left = blocks; left != 0; left &= left - 1) cut_block(std::countr_zero(left));
  if (removed.quanta == before) return;
  removed.tiles.push_back({work_.index, removed.groups.size()});
  if (end_code != kStockNormal) {
    mark_ends(*work_.changed, removed.of(removed.tiles.size() - 1), end_code);
  }
}

void TileCutter::put_tiles() {
  for (Made& made : made_) made.field->put(made.index, std::move(made.tile));
  made_.clear();
}

void TileCutter::cut_block(int block) {
  const Column first{
      work_.index.x * kTileSide + block % kTileBlocksAcross * kBlockSide,
      work_.index.y * kTileSide + block / kTileBlocksAcross * kBlockSide,
  };
  if (first.i >= grid().columns_x || first.j >= grid().columns_y) return;
  const unsigned rows = bound_block(*swept_, grid(), work_.stored, first.i, first.j, block_);
  if (rows == 0 || cut_by_ball(block, first, rows)) return;
  sweep_rows(*swept_, grid(), work_.stored, first.i, first.j, rows, block_);
  if (block_.filled == 0) return;
  const std::int64_t before = removed_->quanta;
  cut_rows(first, block_.filled);
  for (const ColumnBlock::Apart& a : block_.apart) {
    block_.lo_mm[a.row] = a.lo_mm;
    block_.hi_mm[a.row] = a.hi_mm;
    cut_rows(first, 1U << a.row);
  }
  if (removed_->quanta > before) work_.changed->update_bounds(block);
}

/// Cuts rows of a block in one pass, if only a ball above the stock changes them and no column is
/// split. Returns false, without changes, for all other cuts, and in tiles that have to be created
/// or copied first.
bool TileCutter::cut_by_ball(int block, Column first, unsigned rows) {
  if (work_.changed == nullptr) return false;
  const BallSweep* ball = ball_above(*swept_, block_, rows);
  if (ball == nullptr) return false;
  DexelTile& tile = *work_.changed;
  const int row0 = first.j % kTileSide, column0 = first.i % kTileSide;
  for (int row = 0; row < kBlockSide; ++row) {
    if ((tile.split[std::size_t(row0 + row)] >> column0 & 0xFFU) != 0) return false;
  }
  const auto corner = std::size_t(row0 * kTileSide + column0);
  RemovedGroup groups[kBlockSide];
  const LoweredTops lowered =
      lower_tops(*ball, block_, rows, grid(), {&tile.bottom[corner], &tile.top[corner]}, first.i,
                 first.j, groups);
  removed_->groups.insert(removed_->groups.end(), groups, groups + lowered.groups);
  removed_->quanta += lowered.quanta;
  tile.block_top[std::size_t(block)] = lowered.highest;
  return true;
}

/// Subtracts the intervals in block_ of the rows set in `rows`.
void TileCutter::cut_rows(Column first, unsigned rows) {
  RemovedGroup groups[kBlockSide];
  if (work_.stored == nullptr) {
    // The tile is untouched: test whether anything would be removed before creating it. Columns
    // outside the grid or the stock are treated as solid here, but are empty in the created tile.
    std::int32_t bottom[kLanes] = {}, top[kLanes];
    std::ranges::fill(top, grid().height_quanta);
    const std::uint32_t split[kBlockSide] = {};
    BlockChange change;
    subtract_rows(block_, rows, grid(), {bottom, top, split, 0, 0}, first.i, first.j, groups,
                  change);
    if (change.changed == 0 && change.left_overs == 0) return;
    make_editable();
  }
  const int row0 = first.j % kTileSide, column0 = first.i % kTileSide;
  const auto corner = std::size_t(row0 * kTileSide + column0);
  const DexelTile& tile = *work_.stored;
  const BlockElements elements{&tile.bottom[corner], &tile.top[corner],
                               &tile.split[std::size_t(row0)], column0, kTileSide};
  BlockChange change;
  subtract_rows(block_, rows, grid(), elements, first.i, first.j, groups, change);
  const std::size_t first_group = removed_->groups.size();
  if (change.changed != 0) {
    make_editable();
    for (unsigned left = change.changed; left != 0; left &= left - 1) {
      const int row = std::countr_zero(left);
      const std::size_t at = corner + std::size_t(row * kTileSide);
      const BlockChange::Row& stays = change.rows[row];
      std::memcpy(&work_.changed->bottom[at], stays.bottom, sizeof stays.bottom);
      std::memcpy(&work_.changed->top[at], stays.top, sizeof stays.top);
    }
    removed_->groups.insert(removed_->groups.end(), groups, groups + std::popcount(change.changed));
    removed_->quanta += change.quanta;
  }
  for (const BlockChange::LeftOver& rest :
       std::span(change.left_over, std::size_t(change.left_overs))) {
    const unsigned before = change.changed & ((1U << rest.row) - 1);
    const bool has_group = (change.changed >> rest.row & 1) != 0;
    row_groups_.clear();
    if (has_group) row_groups_.push_back(first_group + std::size_t(std::popcount(before)));
    const int column = static_cast<int>(corner) + rest.row * kTileSide;
    for (unsigned left = rest.columns; left != 0; left &= left - 1) {
      const int c = std::countr_zero(left);
      subtract_elements(column + c, {first.i + c, first.j + rest.row},
                        {rest.cut_bottom[c], rest.cut_top[c]});
    }
  }
}

void TileCutter::make_editable() {
  if (work_.changed != nullptr) return;
  work_.changed = field_->editable(work_.index);
  if (work_.changed == nullptr) {
    made_.push_back({field_, work_.index, field_->fresh(work_.index)});
    work_.changed = made_.back().tile.get();
  }
  work_.stored = work_.changed;
}

/// Records a removed element in the first of the row's groups that has no element of the column
/// yet, or in a new group.
KERF_INLINE void TileCutter::record(Column at, Dexel removed) {
  const std::int32_t lane = at.i % kLanes;
  removed_->quanta += removed.top - removed.bottom;
  for (const std::size_t n : row_groups_) {
    RemovedGroup& group = removed_->groups[n];
    if (group.bottom[lane] < group.top[lane]) continue;
    group.bottom[lane] = removed.bottom;
    group.top[lane] = removed.top;
    return;
  }
  row_groups_.push_back(removed_->groups.size());
  RemovedGroup& group = removed_->groups.emplace_back(at.i - lane, at.j);
  group.bottom[lane] = removed.bottom;
  group.top[lane] = removed.top;
}

/// Subtracts a cut from a column of several elements, or from one that the cut splits.
void TileCutter::subtract_elements(int column, Column at, Dexel cut) {
  if (!subtract_in_place(column, at, cut)) rewrite_elements(column, at, cut);
}

/// Subtracts the cut in place if no element has to be added or removed: it removes nothing, one end
/// of one element, or the facing ends of two neighbors. The column's other elements are then not
/// touched. Returns false, without changes, for any other cut.
bool TileCutter::subtract_in_place(int column, Column at, Dexel cut) {
  const auto c = std::size_t(column);
  const Dexel top{work_.stored->bottom[c], work_.stored->top[c]};
  const bool meets_top = top.bottom < cut.top && top.bottom < top.top && cut.bottom < top.top;
  // Nothing is read below a cut that begins in the topmost element.
  if (cut.bottom >= top.bottom || !work_.stored->is_split(column)) {
    return !meets_top || shorten(column, at, cut, 0, top, true);
  }
  const std::span<const Dexel> below = work_.stored->lower.of(column);
  const std::size_t first = count_below(below, cut.bottom);
  const auto meets = [&](std::size_t n) { return n < below.size() && below[n].bottom < cut.top; };
  if (!meets(first)) return !meets_top || shorten(column, at, cut, first, top, true);
  if (!meets(first + 1)) {
    return meets_top ? part(column, at, cut, first, below[first], top, true)
                     : shorten(column, at, cut, first, below[first], false);
  }
  if (meets_top || meets(first + 2)) return false;
  return part(column, at, cut, first, below[first], below[first + 1], false);
}

/// Removes one end of an element, `rest`: the topmost one (`top`) or the lower one with this
/// number. Returns false if the cut removes or divides it.
bool TileCutter::shorten(int column, Column at, Dexel cut, std::size_t lower, Dexel rest,
                         bool top) {
  const Dexel removed{std::max(rest.bottom, cut.bottom), std::min(rest.top, cut.top)};
  if ((removed.bottom > rest.bottom) == (removed.top < rest.top)) return false;
  (removed.bottom > rest.bottom ? rest.top : rest.bottom) =
      removed.bottom > rest.bottom ? removed.bottom : removed.top;
  make_editable();
  if (top) {
    work_.changed->bottom[std::size_t(column)] = rest.bottom;
    work_.changed->top[std::size_t(column)] = rest.top;
  } else {
    work_.changed->lower.edit(column)[lower] = rest;
  }
  record(at, removed);
  return true;
}

/// Removes the facing ends of the lower element with this number, `under`, and of the one above it,
/// `over`, which is the topmost one (`top`) or the next. Returns false if the cut removes one of
/// them.
bool TileCutter::part(int column, Column at, Dexel cut, std::size_t lower, Dexel under, Dexel over,
                      bool top) {
  if (cut.bottom <= under.bottom || cut.top >= over.top) return false;
  make_editable();
  const std::span<Dexel> rest = work_.changed->lower.edit(column);
  rest[lower].top = cut.bottom;
  (top ? work_.changed->bottom[std::size_t(column)] : rest[lower + 1].bottom) = cut.top;
  record(at, {cut.bottom, under.top});
  record(at, {over.bottom, cut.top});
  return true;
}

void TileCutter::rewrite_elements(int column, Column at, Dexel cut) {
  work_.stored->read(column, before_);
  after_.clear();
  bool any = false;
  for (const Dexel& d : before_) {
    const std::int32_t lo = std::max(d.bottom, cut.bottom), hi = std::min(d.top, cut.top);
    if (lo >= hi) {
      after_.push_back(d);
      continue;
    }
    any = true;
    record(at, {lo, hi});
    if (d.bottom < lo) after_.push_back({d.bottom, lo});
    if (hi < d.top) after_.push_back({hi, d.top});
  }
  if (!any) return;
  make_editable();
  work_.changed->write(column, after_);
}

}  // namespace kerf
