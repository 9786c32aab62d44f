// SPDX-License-Identifier: Apache-2.0
#pragma once

// Compiles functions on SIMD lanes (kernel/math/lanes.h) for several instruction sets. The loader
// picks the best version that the CPU supports. Contraction is off, so all versions give equal
// bits, which tests/determinism checks. A build without them has KERF_VECTOR=none.
//
// KERF_INLINE marks every function with lanes as parameters or result. It must be inlined into its
// caller, because the calling convention of vectors depends on the instruction set.
//
// KERF_FOR_EACH_TARGET(Result, name, (parameters), (arguments)) defines the function `name` for the
// base instruction set, AVX2 and AVX-512. Each version calls the inline function name_in_lanes.
// KERF_FOR_BASE_TARGET, KERF_FOR_AVX2_TARGET and KERF_FOR_AVX512_TARGET define one version each,
// for functions that are compiled in three units. KERF_DECLARE_TARGETS(Result, name, (parameters))
// declares all of them.
//
// GCC's target_clones cannot replace these macros, because it lowers vectors to scalars before it
// clones. It does work for plain loops; KERF_VECTOR_CLONES is its attribute. Clang, sanitizers and
// CPUs other than x86-64 get the base version only.

#define KERF_INLINE inline __attribute__((always_inline))

#define KERF_FOR_TARGET(attribute, Result, name, parameters, arguments) \
  attribute Result name parameters { return name##_in_lanes arguments; }
#define KERF_FOR_NO_TARGET(Result, name, parameters, arguments) static_assert(true);

#if !defined(__x86_64__) || defined(__SANITIZE_THREAD__) || defined(__SANITIZE_ADDRESS__) || \
    defined(KERF_VECTOR_NONE) || defined(__clang__)
#define KERF_ONE_TARGET
#define KERF_TARGET_AVX2
#define KERF_TARGET_AVX512
#else
#define KERF_TARGET_BASE __attribute__((target("default")))
#define KERF_TARGET_AVX2 __attribute__((target("arch=x86-64-v3")))
#define KERF_TARGET_AVX512 __attribute__((target("arch=x86-64-v4")))
#endif

#ifdef KERF_ONE_TARGET
#define KERF_VECTOR_CLONES
#define KERF_DECLARE_TARGETS(Result, name, parameters) Result name parameters;
#define KERF_FOR_BASE_TARGET(Result, name, parameters, arguments) \
  KERF_FOR_TARGET(, Result, name, parameters, arguments)
#define KERF_FOR_AVX2_TARGET KERF_FOR_NO_TARGET
#define KERF_FOR_AVX512_TARGET KERF_FOR_NO_TARGET
#else
#define KERF_VECTOR_CLONES \
  __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#define KERF_DECLARE_TARGETS(Result, name, parameters) \
  KERF_TARGET_BASE Result name parameters;             \
  KERF_TARGET_AVX2 Result name parameters;             \
  KERF_TARGET_AVX512 Result name parameters;
#define KERF_FOR_BASE_TARGET(Result, name, parameters, arguments) \
  KERF_FOR_TARGET(KERF_TARGET_BASE, Result, name, parameters, arguments)
#define KERF_FOR_AVX2_TARGET(Result, name, parameters, arguments) \
  KERF_FOR_TARGET(KERF_TARGET_AVX2, Result, name, parameters, arguments)
#define KERF_FOR_AVX512_TARGET(Result, name, parameters, arguments) \
  KERF_FOR_TARGET(KERF_TARGET_AVX512, Result, name, parameters, arguments)
#endif

#define KERF_FOR_EACH_TARGET(Result, name, parameters, arguments) \
  KERF_FOR_BASE_TARGET(Result, name, parameters, arguments)       \
  KERF_FOR_AVX2_TARGET(Result, name, parameters, arguments)       \
  KERF_FOR_AVX512_TARGET(Result, name, parameters, arguments)
