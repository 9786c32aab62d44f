#include "kernel/cut/subtract_row.h"

#include <cstring>

namespace kerf {
namespace {

/// Depths of eight columns. One vector of eight: comparisons of integers this wide stay whole.
typedef std::int32_t DepthLanes __attribute__((vector_size(32), aligned(32)));
typedef std::int32_t HalfDepths __attribute__((vector_size(16), aligned(16)));

KERF_INLINE DepthLanes load(const std::int32_t* from) {
  DepthLanes v;
  std::memcpy(&v, from, sizeof v);
  return v;
}
KERF_INLINE void store(std::int32_t* to, DepthLanes v) { std::memcpy(to, &v, sizeof v); }

KERF_INLINE DepthLanes to_depth(Lanes height_mm, double origin_mm, double inverse_quantum,
                                double block_height) {
  Lanes d = (height_mm - origin_mm) * inverse_quantum;
  d = lesser(greater(d, 0), block_height) + 0.5;
  return __builtin_shufflevector(__builtin_convertvector(d.a, HalfDepths),
                                 __builtin_convertvector(d.b, HalfDepths), 0, 1, 2, 3, 4, 5, 6, 7);
}

KERF_INLINE void subtract_in_lanes(const Lanes& lo_mm, const Lanes& hi_mm, const DexelGrid& grid,
                                   const std::int32_t* bottom, const std::int32_t* top,
                                   unsigned split, RowChange& change) {
  const double inverse = 1 / grid.z_quantum_mm, height = grid.height_quanta;
  const DepthLanes cut_b = to_depth(lo_mm, grid.origin_mm.z, inverse, height);
  const DepthLanes cut_t = to_depth(hi_mm, grid.origin_mm.z, inverse, height);
  const DepthLanes lane_bit{1, 2, 4, 8, 16, 32, 64, 128};
  const DepthLanes b = load(bottom), t = load(top);
  const DepthLanes lo = cut_b > b ? cut_b : b;
  const DepthLanes hi = cut_t < t ? cut_t : t;
  const DepthLanes several = (lane_bit & std::int32_t(split)) != 0;
  const DepthLanes divides = (lo < hi) & (lo > b) & (hi < t);
  const DepthLanes takes = (lo < hi) & ~several & ~divides;
  const DepthLanes left = (several & (cut_b < cut_t)) | divides;
  // The element loses its top, its bottom, or both: then it is gone.
  const DepthLanes gone = takes & (lo == b) & (hi == t);
  const DepthLanes new_t = (takes & (hi == t)) ? lo : t;
  const DepthLanes new_b = (takes & (lo == b)) ? hi : b;
  const DepthLanes removed_lo = takes ? lo : DepthLanes{};
  const DepthLanes removed_hi = takes ? hi : DepthLanes{};
  store(change.cut_bottom, cut_b);
  store(change.cut_top, cut_t);
  store(change.bottom, gone ? DepthLanes{} : new_b);
  store(change.top, gone ? DepthLanes{} : new_t);
  store(change.removed_bottom, removed_lo);
  store(change.removed_top, removed_hi);
  const DepthLanes length = removed_hi - removed_lo;
  std::int64_t quanta = 0;
  std::int32_t left_over = 0;
  for (int c = 0; c < kLanes; ++c) {
    quanta += length[c];
    left_over |= left[c] & lane_bit[c];
  }
  change.quanta = quanta;
  change.left_over = static_cast<unsigned>(left_over);
}
KERF_FOR_EACH_TARGET(void, subtract,
                     (const Lanes& lo_mm, const Lanes& hi_mm, const DexelGrid& grid,
                      const std::int32_t* bottom, const std::int32_t* top, unsigned split,
                      RowChange& change),
                     (lo_mm, hi_mm, grid, bottom, top, split, change))

}  // namespace

void subtract_row(const Lanes& lo_mm, const Lanes& hi_mm, const DexelGrid& grid,
                  const std::int32_t* bottom, const std::int32_t* top, unsigned split,
                  RowChange& change) {
  subtract(lo_mm, hi_mm, grid, bottom, top, split, change);
}

}  // namespace kerf
