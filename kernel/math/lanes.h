// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>

#include "kernel/math/targets.h"

// No function passes vectors between translation units, so their calling convention is irrelevant.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wpsabi"

namespace kerf {

/// Number of doubles in Lanes, and of columns in a group.
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

KERF_INLINE Lanes operator+(Lanes x, Lanes y) { return {x.a + y.a, x.b + y.b}; }
KERF_INLINE Lanes operator-(Lanes x, Lanes y) { return {x.a - y.a, x.b - y.b}; }
KERF_INLINE Lanes operator*(Lanes x, Lanes y) { return {x.a * y.a, x.b * y.b}; }
KERF_INLINE Lanes operator/(Lanes x, Lanes y) { return {x.a / y.a, x.b / y.b}; }
KERF_INLINE Lanes operator-(Lanes x) { return {-x.a, -x.b}; }

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

/// Return the lesser or greater number, or the second one if either is NaN.
KERF_INLINE double lesser(double x, double y) { return x < y ? x : y; }
KERF_INLINE double greater(double x, double y) { return x > y ? x : y; }

/// Returns 0, 1, … 7.
KERF_INLINE Lanes lane_numbers() { return {HalfLanes{0, 1, 2, 3}, HalfLanes{4, 5, 6, 7}}; }

}  // namespace kerf

#pragma GCC diagnostic pop

#ifdef __wasm_simd128__
#include "kernel/math/lane_mask_wasm.h"
#else
#include "kernel/math/lane_mask.h"
#endif
