// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernel/math/lanes.h"

// No function passes vectors between translation units, so their calling convention is irrelevant.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wpsabi"

namespace kerf {

/// Result of a comparison: all bits of a lane are set where it holds.
struct LaneMask {
  HalfMask a, b;
};

KERF_INLINE LaneMask operator<(Lanes x, Lanes y) { return {x.a < y.a, x.b < y.b}; }
KERF_INLINE LaneMask operator>(Lanes x, Lanes y) { return {x.a > y.a, x.b > y.b}; }
KERF_INLINE LaneMask operator<=(Lanes x, Lanes y) { return {x.a <= y.a, x.b <= y.b}; }
KERF_INLINE LaneMask operator>=(Lanes x, Lanes y) { return {x.a >= y.a, x.b >= y.b}; }
KERF_INLINE LaneMask operator==(Lanes x, Lanes y) { return {x.a == y.a, x.b == y.b}; }
KERF_INLINE LaneMask operator&(LaneMask x, LaneMask y) { return {x.a & y.a, x.b & y.b}; }
KERF_INLINE LaneMask operator|(LaneMask x, LaneMask y) { return {x.a | y.a, x.b | y.b}; }
KERF_INLINE LaneMask operator^(LaneMask x, LaneMask y) { return {x.a ^ y.a, x.b ^ y.b}; }
KERF_INLINE LaneMask operator~(LaneMask x) { return {~x.a, ~x.b}; }
KERF_INLINE LaneMask& operator&=(LaneMask& x, LaneMask y) { return x = x & y; }
KERF_INLINE LaneMask& operator|=(LaneMask& x, LaneMask y) { return x = x | y; }

KERF_INLINE Lanes select(LaneMask condition, Lanes yes, Lanes no) {
  return {condition.a ? yes.a : no.a, condition.b ? yes.b : no.b};
}

/// Return the lesser or greater number, or the second one if either is NaN.
KERF_INLINE Lanes lesser(Lanes x, Lanes y) { return select(x < y, x, y); }
KERF_INLINE Lanes greater(Lanes x, Lanes y) { return select(x > y, x, y); }
KERF_INLINE Lanes magnitude(Lanes x) { return select(x < 0.0, -x, x); }

/// Returns a mask with all lanes true.
KERF_INLINE LaneMask every_lane() { return Lanes() == Lanes(); }
/// Returns whether any lane is true.
KERF_INLINE bool any(LaneMask m) {
  const HalfMask either = m.a | m.b;
  const QuarterMask quarter =
      __builtin_shufflevector(either, either, 0, 1) | __builtin_shufflevector(either, either, 2, 3);
  return (quarter[0] | quarter[1]) != 0;
}
/// Returns a mask whose bit i is set where lane i is true.
KERF_INLINE unsigned bits(LaneMask m) {
  const HalfMask weighted = (m.a & HalfMask{1, 2, 4, 8}) | (m.b & HalfMask{16, 32, 64, 128});
  return static_cast<unsigned>(weighted[0] | weighted[1] | weighted[2] | weighted[3]);
}
/// Returns the mask whose lane i is true where bit i is set.
KERF_INLINE LaneMask mask_of(unsigned bits) {
  const std::int64_t b = bits;
  const HalfMask all{b, b, b, b};
  return {(all & HalfMask{1, 2, 4, 8}) != 0, (all & HalfMask{16, 32, 64, 128}) != 0};
}

}  // namespace kerf

#pragma GCC diagnostic pop
