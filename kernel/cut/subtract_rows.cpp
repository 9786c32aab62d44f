// SPDX-License-Identifier: Apache-2.0
#include "kernel/cut/subtract_rows.h"

#include <cstring>

namespace kerf {
namespace {

/// Depths of eight columns, in one vector: unlike doubles, GCC 12 does not split comparisons of
/// integer vectors this wide.
typedef std::int32_t DepthLanes __attribute__((vector_size(32), aligned(32)));
typedef std::int32_t HalfDepths __attribute__((vector_size(16), aligned(16)));
typedef std::int64_t Words __attribute__((vector_size(32), aligned(32)));

KERF_INLINE DepthLanes load(const std::int32_t* from) {
  DepthLanes v;
  std::memcpy(&v, from, sizeof v);
  return v;
}
KERF_INLINE void store(std::int32_t* to, DepthLanes v) { std::memcpy(to, &v, sizeof v); }

KERF_INLINE bool any(DepthLanes mask) {
  const HalfDepths either = __builtin_shufflevector(mask, mask, 0, 1, 2, 3) |
                            __builtin_shufflevector(mask, mask, 4, 5, 6, 7);
  std::uint64_t words[2];
  std::memcpy(words, &either, sizeof words);
  return (words[0] | words[1]) != 0;
}
KERF_INLINE unsigned bits(DepthLanes mask) {
  const DepthLanes weighted = mask & DepthLanes{1, 2, 4, 8, 16, 32, 64, 128};
  Words w;
  std::memcpy(&w, &weighted, sizeof w);
  const auto all = static_cast<std::uint64_t>(w[0] | w[1] | w[2] | w[3]);
  return static_cast<unsigned>(all | all >> 32);
}

/// Converts heights (mm) to depths (quanta), clamped to the stock.
class ToDepth {
 public:
  KERF_INLINE explicit ToDepth(const DexelGrid& grid)
      : origin_mm_(HalfLanes{} + grid.origin_mm.z),
        inverse_quantum_(HalfLanes{} + 1 / grid.z_quantum_mm),
        height_(HalfLanes{} + double(grid.height_quanta)) {}

  KERF_INLINE DepthLanes operator()(const Lanes& height_mm) const {
    return __builtin_shufflevector(half(height_mm.a), half(height_mm.b), 0, 1, 2, 3, 4, 5, 6, 7);
  }

 private:
  KERF_INLINE HalfDepths half(HalfLanes height_mm) const {
    HalfLanes d = (height_mm - origin_mm_) * inverse_quantum_;
    d = d > 0.0 ? d : HalfLanes{};
    d = d < height_ ? d : height_;
    return __builtin_convertvector(d + 0.5, HalfDepths);
  }

  HalfLanes origin_mm_, inverse_quantum_, height_;
};

KERF_INLINE void subtract_in_lanes(const ColumnBlock& block, unsigned rows, const DexelGrid& grid,
                                   const BlockElements& elements, std::int32_t first_i,
                                   std::int32_t first_j, RemovedGroup* groups,
                                   BlockChange& change) {
  const ToDepth to_depth(grid);
  const DepthLanes lane_bit{1, 2, 4, 8, 16, 32, 64, 128};
  Words quanta{};
  unsigned changed = 0;
  int left_overs = 0;
  for (int row = 0; row < kBlockSide; ++row) {
    if ((rows >> row & 1) == 0) continue;
    const DepthLanes cut_b = to_depth(block.lo_mm[row]), cut_t = to_depth(block.hi_mm[row]);
    const DepthLanes b = load(elements.bottom + row * elements.stride);
    const DepthLanes t = load(elements.top + row * elements.stride);
    const auto split = static_cast<std::int32_t>(elements.split[row] >> elements.first_bit & 0xFFU);
    const DepthLanes lo = cut_b > b ? cut_b : b;
    const DepthLanes hi = cut_t < t ? cut_t : t;
    const DepthLanes divides = (lo < hi) & (lo > b) & (hi < t);
    DepthLanes takes = (lo < hi) & ~divides, left = divides;
    if (split != 0) {
      const DepthLanes several = (lane_bit & split) != 0;
      takes &= ~several;
      left |= several & (cut_b < cut_t);
    }
    if (any(takes)) {
      // The element loses its top or its bottom; if it loses both, it is gone.
      const DepthLanes gone = takes & (lo == b) & (hi == t);
      const DepthLanes new_t = (takes & (hi == t)) ? lo : t;
      const DepthLanes new_b = (takes & (lo == b)) ? hi : b;
      BlockChange::Row& stays = change.rows[row];
      store(stays.bottom, gone ? DepthLanes{} : new_b);
      store(stays.top, gone ? DepthLanes{} : new_t);
      const DepthLanes removed_lo = takes ? lo : DepthLanes{};
      const DepthLanes removed_hi = takes ? hi : DepthLanes{};
      RemovedGroup& group = *groups++;
      group.i = first_i;
      group.j = first_j + row;
      store(group.bottom, removed_lo);
      store(group.top, removed_hi);
      const DepthLanes length = removed_hi - removed_lo;
      quanta += __builtin_convertvector(__builtin_shufflevector(length, length, 0, 1, 2, 3), Words);
      quanta += __builtin_convertvector(__builtin_shufflevector(length, length, 4, 5, 6, 7), Words);
      changed |= 1U << row;
    }
    if (any(left)) {
      BlockChange::LeftOver& rest = change.left_over[left_overs++];
      rest.row = row;
      rest.columns = bits(left);
      store(rest.cut_bottom, cut_b);
      store(rest.cut_top, cut_t);
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
