#include "kernel/cut/subtract_row.h"

#include <cstring>

namespace kerf {
namespace {

KERF_INLINE DepthLanes load(const std::int32_t* from) {
  DepthLanes v;
  std::memcpy(&v, from, sizeof v);
  return v;
}
KERF_INLINE void store(std::int32_t* to, DepthLanes v) { std::memcpy(to, &v, sizeof v); }

KERF_INLINE DepthLanes to_depth(Lanes height_mm, double origin_mm, double inverse_quantum,
                                double block_height) {
  Lanes d = (height_mm - origin_mm) * inverse_quantum;
  d = greater(d, splat(0));
  d = lesser(d, splat(block_height));
  return __builtin_convertvector(d + 0.5, DepthLanes);
}

}  // namespace

KERF_VECTOR_CLONES
void quantize(const Lanes& lo_mm, const Lanes& hi_mm, const DexelGrid& grid, CutRow& cut) {
  const double inverse = 1 / grid.z_quantum_mm;
  store(cut.bottom, to_depth(lo_mm, grid.origin_mm.z, inverse, grid.height_quanta));
  store(cut.top, to_depth(hi_mm, grid.origin_mm.z, inverse, grid.height_quanta));
}

KERF_VECTOR_CLONES
bool is_empty(const CutRow& cut) {
  std::int32_t any = 0;
  for (int c = 0; c < kLanes; ++c) any |= cut.bottom[c] < cut.top[c];
  return any == 0;
}

KERF_VECTOR_CLONES
void subtract_row(const CutRow& cut, const std::int32_t* bottom, const std::int32_t* top,
                  unsigned split, RowChange& change) {
  const DepthLanes lane_bit{1, 2, 4, 8, 16, 32, 64, 128};
  const DepthLanes b = load(bottom), t = load(top);
  const DepthLanes cut_b = load(cut.bottom), cut_t = load(cut.top);
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

}  // namespace kerf
