// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <cstring>

#include "kernel/math/lanes.h"

// No function passes vectors between translation units, so their calling convention is irrelevant.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wpsabi"

namespace kerf {

/// Eight 32-bit integers, the counterpart of Lanes. They form one vector, because GCC 12 compares
/// integer vectors of this width as a whole, unlike doubles.
typedef std::int32_t IntLanes __attribute__((vector_size(32), aligned(32)));
typedef std::int32_t HalfIntLanes __attribute__((vector_size(16), aligned(16)));
/// Four 64-bit integers.
typedef std::int64_t LongLanes __attribute__((vector_size(32), aligned(32)));

/// Read or write eight consecutive integers, at any alignment.
KERF_INLINE IntLanes load_ints(const std::int32_t* from) {
  IntLanes v;
  std::memcpy(&v, from, sizeof v);
  return v;
}
KERF_INLINE void store_ints(std::int32_t* to, IntLanes v) { std::memcpy(to, &v, sizeof v); }

KERF_INLINE IntLanes greater(IntLanes x, IntLanes y) { return x > y ? x : y; }
KERF_INLINE IntLanes lesser(IntLanes x, IntLanes y) { return x < y ? x : y; }

/// Converts to doubles, exactly.
KERF_INLINE Lanes to_lanes(IntLanes v) {
  const HalfIntLanes a = __builtin_shufflevector(v, v, 0, 1, 2, 3);
  const HalfIntLanes b = __builtin_shufflevector(v, v, 4, 5, 6, 7);
  return {__builtin_convertvector(a, HalfLanes), __builtin_convertvector(b, HalfLanes)};
}
/// Returns 1 << i in lane i.
KERF_INLINE IntLanes lane_bits() { return IntLanes{1, 2, 4, 8, 16, 32, 64, 128}; }

/// Returns x[i] + x[i + 4] in lane i, in 64 bits, so that the sums cannot overflow.
KERF_INLINE LongLanes sum_of_halves(IntLanes x) {
  return __builtin_convertvector(__builtin_shufflevector(x, x, 0, 1, 2, 3), LongLanes) +
         __builtin_convertvector(__builtin_shufflevector(x, x, 4, 5, 6, 7), LongLanes);
}

}  // namespace kerf

#pragma GCC diagnostic pop

#ifdef __wasm_simd128__
#include "kernel/math/int_mask_wasm.h"
#else
#include "kernel/math/int_mask.h"
#endif
