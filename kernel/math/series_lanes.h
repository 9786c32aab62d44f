// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernel/math/lanes.h"

// No function passes vectors between translation units, so their calling convention is irrelevant.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wpsabi"

namespace kerf {

// Powers, sines and cosines of eight numbers, as series of + − × ÷ only. libm's results differ
// between CPUs, and equal commands must give equal bytes.

namespace series {

/// Added to a double below 2^51, it rounds the double to an integer that its last bits hold.
inline constexpr double kRounder = 6755399441055744.0;  // 1.5 x 2^52
inline constexpr double kLn2 = 0.69314718055994530942;
inline constexpr int kMantissaBits = 52;
inline constexpr std::int64_t kBias = 1023;

/// Returns ln x of normal x > 0, by the series of artanh.
KERF_INLINE HalfLanes logarithm(HalfLanes x) {
  constexpr std::int64_t kMantissa = (std::int64_t{1} << kMantissaBits) - 1;
  const HalfMask all = (HalfMask)x;
  const HalfMask exponent = (all >> kMantissaBits) | (HalfMask)(HalfLanes{} + 0x1p52);
  HalfLanes halvings = (HalfLanes)exponent - (0x1p52 + double(kBias));
  HalfLanes mantissa = (HalfLanes)((all & kMantissa) | (HalfMask)(HalfLanes{} + 1.0));
  const HalfMask large = mantissa > 1.4142135623730951;
  mantissa = large ? mantissa * 0.5 : mantissa;
  halvings = large ? halvings + 1.0 : halvings;
  const HalfLanes s = (mantissa - 1.0) / (mantissa + 1.0), s2 = s * s;
  HalfLanes sum{};
  for (int k = 17; k > 0; k -= 2) sum = sum * s2 + 1.0 / k;
  return halvings * kLn2 + 2.0 * s * sum;
}

/// Returns e^y for |y| < 700.
KERF_INLINE HalfLanes exponential(HalfLanes y) {
  const HalfLanes rounded = y * 1.44269504088896340736 + kRounder;
  const HalfLanes n = rounded - kRounder;
  const HalfLanes r = y - n * kLn2;
  HalfLanes sum = HalfLanes{} + 1.0;
  for (int k = 12; k > 0; --k) sum = 1.0 + sum * r * (1.0 / k);
  const HalfMask twos = (HalfMask)rounded - (HalfMask)(HalfLanes{} + kRounder) + kBias;
  return sum * (HalfLanes)(twos << kMantissaBits);
}

}  // namespace series

/// Returns base^exponent for normal base > 0, with a relative error below 1e-13 where
/// |exponent · ln base| < 30.
KERF_INLINE Lanes power(Lanes base, double exponent) {
  return {series::exponential(exponent * series::logarithm(base.a)),
          series::exponential(exponent * series::logarithm(base.b))};
}

/// Cosines and sines of eight angles.
struct PhaseLanes {
  Lanes cosine, sine;
};
KERF_INLINE PhaseLanes operator*(const PhaseLanes& a, const PhaseLanes& b) {
  return {a.cosine * b.cosine - a.sine * b.sine, a.sine * b.cosine + a.cosine * b.sine};
}
KERF_INLINE PhaseLanes raised(PhaseLanes base, int exponent) {
  PhaseLanes result{Lanes(1), Lanes(0)};
  for (; exponent > 0; exponent /= 2, base = base * base) {
    if (exponent % 2 == 1) result = result * base;
  }
  return result;
}

/// Returns cosine and sine for |turns| < 2^40, with errors below 1e-15 for the fraction.
KERF_INLINE PhaseLanes phase_of_turns(Lanes turns) {
  const Lanes whole = (turns + series::kRounder) - series::kRounder;
  // Taylor at an eighth of the angle (below 0.4), then three doublings.
  const Lanes x = (turns - whole) * (6.28318530717958647692 / 8), x2 = x * x;
  Lanes sine(0), versine(0);  // 1 - cosine, which keeps its digits where the cosine loses them
  for (int k = 17; k >= 1; k -= 2) sine = 1.0 - sine * x2 * (1.0 / ((k + 1) * (k + 2)));
  for (int k = 18; k >= 2; k -= 2) versine = 1.0 - versine * x2 * (1.0 / ((k + 1) * (k + 2)));
  sine = sine * x;
  versine = versine * x2 * 0.5;
  for (int i = 0; i < 3; ++i) {
    const Lanes doubled = 2.0 * sine * (1.0 - versine);
    versine = 2.0 * sine * sine;
    sine = doubled;
  }
  return {1.0 - versine, sine};
}

}  // namespace kerf

#pragma GCC diagnostic pop
