// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>

#include "kernel/math/targets.h"

// No function passes vectors across units, so their calling convention does not matter.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wpsabi"

namespace kerf {

/// Number of doubles in Lanes: the columns of a group.
inline constexpr int kLanes = 8;
typedef double HalfLanes __attribute__((vector_size(32), aligned(32)));
typedef std::int64_t HalfMask __attribute__((vector_size(32), aligned(32)));
typedef std::int64_t QuarterMask __attribute__((vector_size(16), aligned(16)));

/// Eight doubles processed together. Operators work lane by lane and round exactly as plain doubles
/// do, so every instruction set gives the same bits. Stored as two vectors of four, because GCC 12
/// splits comparisons of vectors wider than a register into scalars.
struct Lanes {
  HalfLanes a, b;

  KERF_INLINE Lanes() : a{}, b{} {}
  KERF_INLINE Lanes(HalfLanes first, HalfLanes last) : a(first), b(last) {}
  /// Sets every lane to `v`.
  KERF_INLINE Lanes(double v) : a{v, v, v, v}, b{v, v, v, v} {}
  KERF_INLINE double operator[](int i) const { return i < 4 ? a[i] : b[i - 4]; }
  KERF_INLINE void set(int i, double v) {
    if (i < 4) {
      a[i] = v;
    } else {
      b[i - 4] = v;
    }
  }
};

/// Result of a comparison: all bits of a lane are set where it holds.
struct LaneMask {
  HalfMask a, b;
};

KERF_INLINE Lanes operator+(Lanes x, Lanes y) { return {x.a + y.a, x.b + y.b}; }
KERF_INLINE Lanes operator-(Lanes x, Lanes y) { return {x.a - y.a, x.b - y.b}; }
KERF_INLINE Lanes operator*(Lanes x, Lanes y) { return {x.a * y.a, x.b * y.b}; }
KERF_INLINE Lanes operator/(Lanes x, Lanes y) { return {x.a / y.a, x.b / y.b}; }
KERF_INLINE Lanes operator-(Lanes x) { return {-x.a, -x.b}; }
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

/// Converts v to the type of the first argument, in code for both double and Lanes.
KERF_INLINE double splat_like(double, double v) { return v; }
KERF_INLINE Lanes splat_like(Lanes, double v) { return Lanes(v); }

KERF_INLINE double square_root(double v) { return std::sqrt(v); }
KERF_INLINE Lanes square_root(Lanes v) {
  for (int i = 0; i < 4; ++i) v.a[i] = std::sqrt(v.a[i]);
  for (int i = 0; i < 4; ++i) v.b[i] = std::sqrt(v.b[i]);
  return v;
}

KERF_INLINE double select(bool condition, double yes, double no) { return condition ? yes : no; }
KERF_INLINE Lanes select(LaneMask condition, Lanes yes, Lanes no) {
  return {condition.a ? yes.a : no.a, condition.b ? yes.b : no.b};
}

/// Return the lesser or greater number; the second where either is NaN.
KERF_INLINE double lesser(double x, double y) { return x < y ? x : y; }
KERF_INLINE double greater(double x, double y) { return x > y ? x : y; }
KERF_INLINE Lanes lesser(Lanes x, Lanes y) { return select(x < y, x, y); }
KERF_INLINE Lanes greater(Lanes x, Lanes y) { return select(x > y, x, y); }
KERF_INLINE Lanes magnitude(Lanes x) { return select(x < 0.0, -x, x); }

/// Returns 0, 1, … 7.
KERF_INLINE Lanes lane_numbers() { return {HalfLanes{0, 1, 2, 3}, HalfLanes{4, 5, 6, 7}}; }

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
