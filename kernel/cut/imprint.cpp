// SPDX-License-Identifier: Apache-2.0
#include "kernel/cut/imprint.h"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstring>
#include <span>
#include <vector>

#include "kernel/cut/subtract_rows.h"
#include "kernel/cut/swept_block.h"

namespace kerf {
namespace {

/// Removes the imprint from one part of a removal.
class ImprintTaker {
 public:
  ImprintTaker(const SweptTool& standing, const DexelGrid& grid)
      : standing_(standing), grid_(grid) {}

  /// Returns the length of the imprint in `part`, in quanta.
  std::int64_t take(RemovedPart& part) {
    std::size_t begin = 0;
    for (RemovedPart::Tile& tile : part.tiles) {
      for (std::size_t n = begin; n < tile.end; ++n) take(part.groups[n]);
      begin = tile.end;
      tile.end = left_.size();
    }
    part.groups.swap(left_);
    part.quanta -= quanta_;
    return quanta_;
  }

 private:
  /// Appends the remainder of a group to left_.
  void take(const RemovedGroup& group) {
    place(group);
    const int row = group.j % kBlockSide;
    if ((block_.filled >> row & 1) == 0) {
      left_.push_back(group);
      return;
    }
    rest_.assign(1, group);
    subtract(row, block_.lo_mm[row], block_.hi_mm[row]);
    for (const ColumnBlock::Apart& a : block_.apart) {
      if (a.row == row) subtract(row, a.lo_mm, a.hi_mm);
    }
    for (const RemovedGroup& rest : rest_) {
      if (!is_empty(rest)) left_.push_back(rest);
    }
  }

  /// Evaluates the tool over the block of a group, unless it is that of the previous group.
  void place(const RemovedGroup& group) {
    const std::int32_t j = group.j - group.j % kBlockSide;
    if (group.i == block_i_ && j == block_j_) return;
    block_i_ = group.i;
    block_j_ = j;
    sweep_block(standing_, grid_, nullptr, block_i_, block_j_, block_);
  }

  /// Subtracts one interval of each column from the elements in rest_.
  void subtract(int row, const Lanes& lo_mm, const Lanes& hi_mm) {
    constexpr std::uint32_t kNotSplit[kBlockSide] = {};
    interval_.lo_mm[row] = lo_mm;
    interval_.hi_mm[row] = hi_mm;
    const std::size_t count = rest_.size();
    for (std::size_t n = 0; n < count; ++n) {
      RemovedGroup rest = rest_[n], taken[kBlockSide];
      BlockChange change;
      subtract_rows(interval_, 1U << row, grid_, {rest.bottom, rest.top, kNotSplit, 0, 0}, rest.i,
                    rest.j, taken, change);
      if (change.changed != 0) {
        std::memcpy(rest.bottom, change.rows[row].bottom, sizeof rest.bottom);
        std::memcpy(rest.top, change.rows[row].top, sizeof rest.top);
        quanta_ += change.quanta;
      }
      if (change.left_overs != 0) divide(rest, change.left_over[0]);
      rest_[n] = rest;
    }
  }

  /// Divides the elements that enclose the interval: `rest` keeps the lower parts, and a new group
  /// gets the upper ones.
  void divide(RemovedGroup& rest, const BlockChange::LeftOver& cut) {
    RemovedGroup upper{rest.i, rest.j, {}, {}};
    for (unsigned left = cut.columns; left != 0; left &= left - 1) {
      const int c = std::countr_zero(left);
      upper.bottom[c] = cut.cut_top[c];
      upper.top[c] = rest.top[c];
      rest.top[c] = cut.cut_bottom[c];
      quanta_ += cut.cut_top[c] - cut.cut_bottom[c];
    }
    rest_.push_back(upper);
  }

  static bool is_empty(const RemovedGroup& group) {
    for (int c = 0; c < RemovedGroup::kLanes; ++c) {
      if (group.bottom[c] < group.top[c]) return false;
    }
    return true;
  }

  const SweptTool& standing_;
  const DexelGrid& grid_;
  ColumnBlock block_, interval_;
  std::int32_t block_i_ = -1, block_j_ = -1;
  std::vector<RemovedGroup> rest_, left_;
  std::int64_t quanta_ = 0;
};

}  // namespace

std::int64_t take_imprint(const SweptTool& standing, const DexelGrid& grid, RemovedPart& removed) {
  if (removed.tiles.empty() || standing.pieces.empty()) return 0;
  return ImprintTaker(standing, grid).take(removed);
}

}  // namespace kerf
