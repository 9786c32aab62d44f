// SPDX-License-Identifier: Apache-2.0
#include "kernel/cut/subtract_rows.h"

#include <cstddef>

#include "kernel/cut/to_depth.h"
#include "kernel/math/int_lanes.h"

namespace kerf {
namespace {

KERF_INLINE void subtract_in_lanes(const ColumnBlock& block, unsigned rows, const DexelGrid& grid,
                                   const BlockElements& elements, std::int32_t first_i,
                                   std::int32_t first_j, RemovedGroup* groups,
                                   BlockChange& change) {
  const ToDepth to_depth(grid);
  LongLanes quanta{};
  unsigned changed = 0;
  int left_overs = 0;
  for (int row = 0; row < kBlockSide; ++row) {
    if ((rows >> row & 1) == 0) continue;
    const IntLanes cut_b = to_depth(block.lo_mm[row]), cut_t = to_depth(block.hi_mm[row]);
    const std::ptrdiff_t offset = std::ptrdiff_t(row) * elements.stride;
    const IntLanes b = load_ints(elements.bottom + offset);
    const IntLanes t = load_ints(elements.top + offset);
    const auto split = static_cast<std::int32_t>(elements.split[row] >> elements.first_bit & 0xFFU);
    const IntLanes lo = greater(cut_b, b);
    const IntLanes hi = lesser(cut_t, t);
    const IntMask cuts = less(lo, hi);
    const IntMask divides = cuts & less(b, lo) & less(hi, t);
    IntMask takes = cuts & ~divides, left = divides;
    if (split != 0) {
      const IntMask several = equal(lane_bits() & split, lane_bits());
      takes &= ~several;
      left |= several & less(cut_b, cut_t);
    }
    if (any(takes)) {
      // The element loses its top or its bottom, or vanishes if it loses both.
      const IntMask at_bottom = takes & equal(lo, b), at_top = takes & equal(hi, t);
      const IntMask gone = at_bottom & at_top;
      BlockChange::Row& stays = change.rows[row];
      store_ints(stays.bottom, select(gone, IntLanes{}, select(at_bottom, hi, b)));
      store_ints(stays.top, select(gone, IntLanes{}, select(at_top, lo, t)));
      const IntLanes removed_lo = select(takes, lo, IntLanes{});
      const IntLanes removed_hi = select(takes, hi, IntLanes{});
      RemovedGroup& group = *groups++;
      group.i = first_i;
      group.j = first_j + row;
      store_ints(group.bottom, removed_lo);
      store_ints(group.top, removed_hi);
      quanta += sum_of_halves(removed_hi - removed_lo);
      changed |= 1U << row;
    }
    if (any(left)) {
      BlockChange::LeftOver& rest = change.left_over[left_overs++];
      rest.row = row;
      rest.columns = bits(left);
      store_ints(rest.cut_bottom, cut_b);
      store_ints(rest.cut_top, cut_t);
    }
  }
  change.changed = changed;
  change.left_overs = left_overs;
  change.quanta = quanta[0] + quanta[1] + quanta[2] + quanta[3];
}
KERF_FOR_EACH_TARGET(void, subtract,
                     (const ColumnBlock& block, unsigned rows, const DexelGrid& grid,
                      const BlockElements& elements, std::int32_t first_i, std::int32_t first_j,
                      RemovedGroup* groups, BlockChange& change),
                     (block, rows, grid, elements, first_i, first_j, groups, change))

}  // namespace

void subtract_rows(const ColumnBlock& block, unsigned rows, const DexelGrid& grid,
                   const BlockElements& elements, std::int32_t first_i, std::int32_t first_j,
                   RemovedGroup* groups, BlockChange& change) {
  subtract(block, rows, grid, elements, first_i, first_j, groups, change);
}

}  // namespace kerf
