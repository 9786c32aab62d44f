#pragma once

#include "kernel/dexel/tile_index.h"
#include "kernel/math/vec3.h"

namespace kerf {

/// A run of neighbouring columns of one row, and where a swept piece says which heights it removes
/// from each: the unit that the sweep evaluates at once, small enough for the nearest cache and
/// long enough to fill vector registers.
struct ColumnRow {
  double y_mm = 0;
  double x_mm[kTileSide];
  double lo_mm[kTileSide];  ///< out: lowest removed height; +inf where the piece misses the column
  double hi_mm[kTileSide];  ///< out: highest removed height; -inf where it misses
  int count = 0;            ///< columns in use, at most kTileSide
};

/// Limits of a swept piece; nothing outside is removed.
struct SweepBounds {
  Vec3 min_mm, max_mm;
};

/// A range of x (mm); empty when lo > hi.
struct XRange {
  double lo_mm, hi_mm;
};

// The loops over a row are compiled for three instruction sets. With contraction off all give equal
// bits.
#if defined(__x86_64__) && !defined(__SANITIZE_THREAD__) && !defined(__SANITIZE_ADDRESS__)
#define KERF_VECTOR_CLONES \
  __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#else
#define KERF_VECTOR_CLONES
#endif

}  // namespace kerf
