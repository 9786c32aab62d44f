// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <cstring>

#include "kernel/math/lanes.h"

namespace kerf {

/// Eight 32-bit integers, beside the eight doubles of Lanes. A comparison gives −1 where it holds
/// and 0 elsewhere; `mask ? a : b` selects. One vector of eight: unlike for doubles, GCC 12
/// compares integers of this width as a whole.
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
/// Converts to integers, rounding towards zero. Every value must fit into 32 bits.
KERF_INLINE IntLanes to_int_lanes(Lanes v) {
  return __builtin_shufflevector(__builtin_convertvector(v.a, HalfIntLanes),
                                 __builtin_convertvector(v.b, HalfIntLanes), 0, 1, 2, 3, 4, 5, 6,
                                 7);
}

/// Returns 1 << i in lane i.
KERF_INLINE IntLanes lane_bits() { return IntLanes{1, 2, 4, 8, 16, 32, 64, 128}; }

/// Returns whether any lane of a mask is true.
KERF_INLINE bool any(IntLanes mask) {
  const HalfIntLanes either = __builtin_shufflevector(mask, mask, 0, 1, 2, 3) |
                              __builtin_shufflevector(mask, mask, 4, 5, 6, 7);
  std::uint64_t words[2];
  std::memcpy(words, &either, sizeof words);
  return (words[0] | words[1]) != 0;
}
/// Returns a mask whose bit i is set where lane i of a mask is true.
KERF_INLINE unsigned bits(IntLanes mask) {
  const IntLanes weighted = mask & lane_bits();
  LongLanes w;
  std::memcpy(&w, &weighted, sizeof w);
  const auto all = static_cast<std::uint64_t>(w[0] | w[1] | w[2] | w[3]);
  return static_cast<unsigned>(all | all >> 32);
}

/// Returns x[i] + x[i + 4] in lane i, in 64 bits, so that the sums cannot overflow.
KERF_INLINE LongLanes sum_of_halves(IntLanes x) {
  return __builtin_convertvector(__builtin_shufflevector(x, x, 0, 1, 2, 3), LongLanes) +
         __builtin_convertvector(__builtin_shufflevector(x, x, 4, 5, 6, 7), LongLanes);
}

}  // namespace kerf
