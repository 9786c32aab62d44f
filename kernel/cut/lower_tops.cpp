// SPDX-License-Identifier: Apache-2.0
#include "kernel/cut/lower_tops.h"

#include <limits>
#include <span>

#include "kernel/cut/to_depth.h"
#include "kernel/dexel/tile_index.h"
#include "kernel/math/int_lanes.h"

namespace kerf {
namespace {

/// Returns the lowest end of a chain of capsules on each ray; +inf where they miss it.
KERF_INLINE Lanes lower_end_of(std::span<const RayCapsule> capsules, Lanes x, Lanes y) {
  Lanes lowest = std::numeric_limits<double>::infinity();
  for (const RayCapsule& c : capsules) {
    const LaneEnd end = c.lower_end(x, y);
    lowest = select(end.hit & (end.z < lowest), end.z, lowest);
  }
  return lowest;
}

/// Shortens eight elements to the depths `cut` and sets the group of the removed ones. `cuts` is
/// where an element is cut.
KERF_INLINE IntLanes shorten_row(IntLanes cut, IntMask cuts, IntLanes bottom, IntLanes top,
                                 std::int32_t* row_bottom, RemovedGroup& group) {
  const IntMask gone = cuts & equal(cut, bottom);
  if (any(gone)) store_ints(row_bottom, select(gone, IntLanes{}, bottom));
  store_ints(group.bottom, select(cuts, cut, IntLanes{}));
  store_ints(group.top, select(cuts, top, IntLanes{}));
  return select(gone, IntLanes{}, select(cuts, cut, top));
}

KERF_INLINE std::int32_t highest_of(IntLanes tops) {
  std::int32_t highest = 0;
  for (int c = 0; c < kLanes; ++c) highest = tops[c] > highest ? tops[c] : highest;
  return highest;
}

KERF_INLINE LoweredTops lower_in_lanes(std::span<const RayCapsule> capsules,
                                       const ColumnBlock& block, unsigned rows,
                                       const DexelGrid& grid, const SingleElements& elements,
                                       std::int32_t first_i, std::int32_t first_j,
                                       RemovedGroup* groups) {
  const ToDepth to_depth(grid);
  LoweredTops result;
  LongLanes quanta{};
  IntLanes highest{};
  for (int row = 0; row < kBlockSide; ++row) {
    std::int32_t* const row_top = elements.top + row * kTileSide;
    IntLanes top = load_ints(row_top);
    if ((rows >> row & 1) != 0) {
      std::int32_t* const row_bottom = elements.bottom + row * kTileSide;
      const IntLanes bottom = load_ints(row_bottom);
      const Lanes end = lower_end_of(capsules, block.x_mm, Lanes(block.y_mm[row]));
      const IntLanes cut = greater(to_depth(end), bottom);
      const IntMask cuts = less(cut, top);
      if (any(cuts)) {
        RemovedGroup& group = groups[result.groups++];
        group.i = first_i;
        group.j = first_j + row;
        quanta += sum_of_halves(select(cuts, top - cut, IntLanes{}));
        top = shorten_row(cut, cuts, bottom, top, row_bottom, group);
        store_ints(row_top, top);
      }
    }
    highest = greater(highest, top);
  }
  result.quanta = quanta[0] + quanta[1] + quanta[2] + quanta[3];
  result.highest = highest_of(highest);
  return result;
}
KERF_FOR_EACH_TARGET(LoweredTops, lower,
                     (std::span<const RayCapsule> capsules, const ColumnBlock& block, unsigned rows,
                      const DexelGrid& grid, const SingleElements& elements, std::int32_t first_i,
                      std::int32_t first_j, RemovedGroup* groups),
                     (capsules, block, rows, grid, elements, first_i, first_j, groups))

}  // namespace

LoweredTops lower_tops(const BallSweep& ball, const ColumnBlock& block, unsigned rows,
                       const DexelGrid& grid, const SingleElements& elements, std::int32_t first_i,
                       std::int32_t first_j, RemovedGroup* groups) {
  return lower(ball.capsules(), block, rows, grid, elements, first_i, first_j, groups);
}

}  // namespace kerf
