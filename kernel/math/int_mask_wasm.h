// SPDX-License-Identifier: Apache-2.0
#pragma once

#ifdef __wasm_simd128__  // Empty for other machines, so that it compiles alone there too.

#include <wasm_simd128.h>

#include "kernel/math/int_lanes.h"

// No function passes vectors between translation units, so their calling convention is irrelevant.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wpsabi"

namespace kerf {

// The WebAssembly version of kernel/math/int_mask.h, for the reasons given in
// kernel/math/lane_mask_wasm.h. Clang 19 converts wide vectors of doubles to integers one by one,
// with a range test for each.

/// Result of a comparison of integers: −1 in a lane where it holds, else 0.
struct IntMask {
  v128_t p, q;
};

namespace wasm {

KERF_INLINE v128_t low(IntLanes v) { return (v128_t)__builtin_shufflevector(v, v, 0, 1, 2, 3); }
KERF_INLINE v128_t high(IntLanes v) { return (v128_t)__builtin_shufflevector(v, v, 4, 5, 6, 7); }
KERF_INLINE IntLanes joined_ints(v128_t low, v128_t high) {
  return __builtin_shufflevector((HalfIntLanes)low, (HalfIntLanes)high, 0, 1, 2, 3, 4, 5, 6, 7);
}

}  // namespace wasm

KERF_INLINE IntMask less(IntLanes x, IntLanes y) {
  using namespace wasm;
  return {wasm_i32x4_lt(low(x), low(y)), wasm_i32x4_lt(high(x), high(y))};
}
KERF_INLINE IntMask equal(IntLanes x, IntLanes y) {
  using namespace wasm;
  return {wasm_i32x4_eq(low(x), low(y)), wasm_i32x4_eq(high(x), high(y))};
}
KERF_INLINE IntMask operator&(IntMask x, IntMask y) { return {x.p & y.p, x.q & y.q}; }
KERF_INLINE IntMask operator|(IntMask x, IntMask y) { return {x.p | y.p, x.q | y.q}; }
KERF_INLINE IntMask operator~(IntMask x) { return {~x.p, ~x.q}; }
KERF_INLINE IntMask& operator&=(IntMask& x, IntMask y) { return x = x & y; }
KERF_INLINE IntMask& operator|=(IntMask& x, IntMask y) { return x = x | y; }
KERF_INLINE IntLanes select(IntMask m, IntLanes yes, IntLanes no) {
  using namespace wasm;
  return joined_ints(wasm_v128_bitselect(low(yes), low(no), m.p),
                     wasm_v128_bitselect(high(yes), high(no), m.q));
}
/// Returns whether any lane of a mask is true.
KERF_INLINE bool any(IntMask mask) { return wasm_v128_any_true(mask.p | mask.q); }
/// Returns a mask whose bit i is set where lane i of a mask is true.
KERF_INLINE unsigned bits(IntMask mask) {
  return wasm_i16x8_bitmask(wasm_i16x8_narrow_i32x4(mask.p, mask.q));
}

/// Converts to integers, rounding towards zero. Every value must fit into 32 bits.
KERF_INLINE IntLanes to_int_lanes(Lanes v) {
  // The last bits of a double near 1.5 x 2^52 are those of the integer.
  const auto rounded = [](v128_t x) __attribute__((always_inline)) {
    return wasm_f64x2_add(wasm_f64x2_trunc(x), wasm_f64x2_const_splat(0x1.8p52));
  };
  using namespace wasm;
  return joined_ints(wasm_i32x4_shuffle(rounded(low(v.a)), rounded(high(v.a)), 0, 2, 4, 6),
                     wasm_i32x4_shuffle(rounded(low(v.b)), rounded(high(v.b)), 0, 2, 4, 6));
}

}  // namespace kerf

#pragma GCC diagnostic pop

#endif
