#pragma once

#include "kernel/dexel/tile_index.h"
#include "kernel/math/vec3.h"

namespace kerf {

/// A run of neighbouring columns of one row, and where a swept piece says which heights it removes
/// from each: the unit that the sweep evaluates at once, small enough for the nearest cache and
/// long enough to fill vector registers.
struct ColumnRow {
  double y_mm = 0;
  alignas(64) double x_mm[kTileSide];
  alignas(64) double lo_mm[kTileSide];  ///< out: lowest removed height; +inf where the piece misses
                                        ///< the column
  alignas(64) double hi_mm[kTileSide];  ///< out: highest removed height; -inf where it misses
  int count = 0;                        ///< columns in use, at most kTileSide
  int lanes = 0;                        ///< count rounded up to whole vectors: what loops run over

  /// Takes the columns x(0) … x(n − 1); the lanes behind them repeat the last one.
  template <class X>
  void assign(int n, X x) {
    count = n;
    lanes = (n + kLanes - 1) / kLanes * kLanes;
    for (int c = 0; c < lanes; ++c) x_mm[c] = x(c < n ? c : n - 1);
  }

  static constexpr int kLanes = 8;  ///< doubles in the widest vector
};

/// Limits of a swept piece; nothing outside is removed.
struct SweepBounds {
  Vec3 min_mm, max_mm;
};

/// A plane z = at_origin + by_x x + by_y y that no point of a swept piece lies below. Where the
/// stock is lower already, the piece has nothing to remove and is not evaluated.
struct LowerPlane {
  double at_origin_mm, by_x, by_y;
};

/// A range of x (mm); empty when lo > hi.
struct XRange {
  double lo_mm, hi_mm;
};

// The loops over a row are compiled for three instruction sets, of which the program takes the best
// that the CPU has. With contraction off all give equal bits; to show it, a build may ask for one
// of them (CMake's KERF_VECTOR). Clang 19 drops inline functions that only clones call, so a build
// by Clang gets no clones.
#if !defined(__x86_64__) || defined(__SANITIZE_THREAD__) || defined(__SANITIZE_ADDRESS__) || \
    defined(KERF_VECTOR_NONE)
#define KERF_VECTOR_CLONES
#elif defined(KERF_VECTOR_AVX2)
#define KERF_VECTOR_CLONES __attribute__((target("arch=x86-64-v3")))
#elif defined(KERF_VECTOR_AVX512)
#define KERF_VECTOR_CLONES __attribute__((target("arch=x86-64-v4")))
#elif defined(__clang__)
#define KERF_VECTOR_CLONES
#else
#define KERF_VECTOR_CLONES \
  __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#endif

}  // namespace kerf
