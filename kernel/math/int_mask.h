// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernel/math/int_lanes.h"

// No function passes vectors between translation units, so their calling convention is irrelevant.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wpsabi"

namespace kerf {

/// Result of a comparison of integers: −1 in a lane where it holds, else 0.
using IntMask = IntLanes;

KERF_INLINE IntMask less(IntLanes x, IntLanes y) { return x < y; }
KERF_INLINE IntMask equal(IntLanes x, IntLanes y) { return x == y; }
KERF_INLINE IntLanes select(IntMask condition, IntLanes yes, IntLanes no) {
  return condition ? yes : no;
}
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

/// Converts to integers, rounding towards zero. Every value must fit into 32 bits.
KERF_INLINE IntLanes to_int_lanes(Lanes v) {
  return __builtin_shufflevector(__builtin_convertvector(v.a, HalfIntLanes),
                                 __builtin_convertvector(v.b, HalfIntLanes), 0, 1, 2, 3, 4, 5, 6,
                                 7);
}

}  // namespace kerf

#pragma GCC diagnostic pop
