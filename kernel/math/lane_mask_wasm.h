// SPDX-License-Identifier: Apache-2.0
#pragma once

#ifdef __wasm_simd128__  // Empty for other machines, so that it compiles alone there too.

#include <wasm_simd128.h>

#include "kernel/math/lanes.h"

// No function passes vectors between translation units, so their calling convention is irrelevant.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wpsabi"

namespace kerf {

// The WebAssembly version of kernel/math/lane_mask.h, with vectors of two doubles. Clang 19 packs
// the masks of wider vectors into narrower ones, and unpacks them again, at every step.

typedef double QuarterLanes __attribute__((vector_size(16), aligned(16)));

/// Result of a comparison: all bits of a lane are set where it holds.
struct LaneMask {
  v128_t p, q, r, s;
};

namespace wasm {

KERF_INLINE v128_t low(HalfLanes v) { return (v128_t)__builtin_shufflevector(v, v, 0, 1); }
KERF_INLINE v128_t high(HalfLanes v) { return (v128_t)__builtin_shufflevector(v, v, 2, 3); }
KERF_INLINE HalfLanes joined(v128_t low, v128_t high) {
  return __builtin_shufflevector((QuarterLanes)low, (QuarterLanes)high, 0, 1, 2, 3);
}

}  // namespace wasm

#define KERF_WASM_COMPARE(symbol, instruction)              \
  KERF_INLINE LaneMask operator symbol(Lanes x, Lanes y) {  \
    return {instruction(wasm::low(x.a), wasm::low(y.a)),    \
            instruction(wasm::high(x.a), wasm::high(y.a)),  \
            instruction(wasm::low(x.b), wasm::low(y.b)),    \
            instruction(wasm::high(x.b), wasm::high(y.b))}; \
  }
KERF_WASM_COMPARE(<, wasm_f64x2_lt)
KERF_WASM_COMPARE(>, wasm_f64x2_gt)
KERF_WASM_COMPARE(<=, wasm_f64x2_le)
KERF_WASM_COMPARE(>=, wasm_f64x2_ge)
KERF_WASM_COMPARE(==, wasm_f64x2_eq)
#undef KERF_WASM_COMPARE

KERF_INLINE LaneMask operator&(LaneMask x, LaneMask y) {
  return {x.p & y.p, x.q & y.q, x.r & y.r, x.s & y.s};
}
KERF_INLINE LaneMask operator|(LaneMask x, LaneMask y) {
  return {x.p | y.p, x.q | y.q, x.r | y.r, x.s | y.s};
}
KERF_INLINE LaneMask operator^(LaneMask x, LaneMask y) {
  return {x.p ^ y.p, x.q ^ y.q, x.r ^ y.r, x.s ^ y.s};
}
KERF_INLINE LaneMask operator~(LaneMask x) { return {~x.p, ~x.q, ~x.r, ~x.s}; }
KERF_INLINE LaneMask& operator&=(LaneMask& x, LaneMask y) { return x = x & y; }
KERF_INLINE LaneMask& operator|=(LaneMask& x, LaneMask y) { return x = x | y; }

KERF_INLINE Lanes select(LaneMask m, Lanes yes, Lanes no) {
  using namespace wasm;
  return {joined(wasm_v128_bitselect(low(yes.a), low(no.a), m.p),
                 wasm_v128_bitselect(high(yes.a), high(no.a), m.q)),
          joined(wasm_v128_bitselect(low(yes.b), low(no.b), m.r),
                 wasm_v128_bitselect(high(yes.b), high(no.b), m.s))};
}

/// Return the lesser or greater number, or the second one if either is NaN.
KERF_INLINE Lanes lesser(Lanes x, Lanes y) {
  using namespace wasm;
  return {joined(wasm_f64x2_pmin(low(y.a), low(x.a)), wasm_f64x2_pmin(high(y.a), high(x.a))),
          joined(wasm_f64x2_pmin(low(y.b), low(x.b)), wasm_f64x2_pmin(high(y.b), high(x.b)))};
}
KERF_INLINE Lanes greater(Lanes x, Lanes y) {
  using namespace wasm;
  return {joined(wasm_f64x2_pmax(low(y.a), low(x.a)), wasm_f64x2_pmax(high(y.a), high(x.a))),
          joined(wasm_f64x2_pmax(low(y.b), low(x.b)), wasm_f64x2_pmax(high(y.b), high(x.b)))};
}
KERF_INLINE Lanes magnitude(Lanes x) { return select(x < 0.0, -x, x); }

/// Returns a mask with all lanes true.
KERF_INLINE LaneMask every_lane() {
  const v128_t all = wasm_i64x2_const_splat(-1);
  return {all, all, all, all};
}
/// Returns whether any lane is true.
KERF_INLINE bool any(LaneMask m) { return wasm_v128_any_true((m.p | m.q) | (m.r | m.s)); }
/// Returns a mask whose bit i is set where lane i is true.
KERF_INLINE unsigned bits(LaneMask m) {
  // Eight lanes of 32 bits, then of 16.
  const v128_t first = wasm_i32x4_shuffle(m.p, m.q, 0, 2, 4, 6);
  const v128_t last = wasm_i32x4_shuffle(m.r, m.s, 0, 2, 4, 6);
  return wasm_i16x8_bitmask(wasm_i16x8_narrow_i32x4(first, last));
}
/// Returns the mask whose lane i is true where bit i is set.
KERF_INLINE LaneMask mask_of(unsigned bits) {
  const v128_t all = wasm_i64x2_splat(bits);
  const auto of = [all](std::int64_t low, std::int64_t high) __attribute__((always_inline)) {
    const v128_t one = wasm_i64x2_make(low, high);
    return wasm_i64x2_eq(all & one, one);
  };
  return {of(1, 2), of(4, 8), of(16, 32), of(64, 128)};
}

}  // namespace kerf

#pragma GCC diagnostic pop

#endif
