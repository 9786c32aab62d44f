#pragma once

#include <cmath>
#include <cstdint>

namespace kerf {

/// Eight numbers that are computed with at once: the columns of a group. The compiler maps them to
/// whatever vector registers the target has; operators work lane by lane and round exactly as
/// plain doubles do, so every instruction set gives the same bits.
inline constexpr int kLanes = 8;
typedef double Lanes __attribute__((vector_size(64), aligned(64)));
typedef std::int64_t LaneMask
    __attribute__((vector_size(64), aligned(64)));  ///< −1 where true, 0 where false
typedef std::int32_t DepthLanes __attribute__((vector_size(32), aligned(32)));

// Lanes are only passed between functions that become one: how a vector is passed depends on the
// instruction set.
#define KERF_INLINE inline __attribute__((always_inline))

// The loops over lanes are compiled for three instruction sets, of which the program takes the best
// that the CPU has. With contraction off all give equal bits; to show it, a build may ask for one
// of them (CMake's KERF_VECTOR). Clang refuses vectors in functions of several instruction sets, so
// a build by Clang gets no clones.
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

KERF_INLINE Lanes splat(double v) { return Lanes{} + v; }
KERF_INLINE double splat_like(double, double v) { return v; }
KERF_INLINE Lanes splat_like(Lanes, double v) { return splat(v); }

KERF_INLINE double square_root(double v) { return std::sqrt(v); }
KERF_INLINE Lanes square_root(Lanes v) {
  Lanes r;
  for (int i = 0; i < kLanes; ++i) r[i] = std::sqrt(v[i]);
  return r;
}

KERF_INLINE double select(bool condition, double yes, double no) { return condition ? yes : no; }
KERF_INLINE Lanes select(LaneMask condition, Lanes yes, Lanes no) { return condition ? yes : no; }

/// Lesser and greater; the second where either is not a number.
KERF_INLINE Lanes lesser(Lanes a, Lanes b) { return a < b ? a : b; }
KERF_INLINE Lanes greater(Lanes a, Lanes b) { return a > b ? a : b; }
KERF_INLINE Lanes magnitude(Lanes a) { return a < 0.0 ? -a : a; }

KERF_INLINE bool any(LaneMask m) {
  std::int64_t any = 0;
  for (int i = 0; i < kLanes; ++i) any |= m[i];
  return any != 0;
}

/// Bit i is set where lane i is true.
KERF_INLINE unsigned bits(LaneMask m) {
  unsigned bits = 0;
  for (int i = 0; i < kLanes; ++i) bits |= unsigned(m[i] & 1) << i;
  return bits;
}

/// The lane numbers 0 … 7.
KERF_INLINE Lanes lane_numbers() { return Lanes{0, 1, 2, 3, 4, 5, 6, 7}; }

}  // namespace kerf
