// SPDX-License-Identifier: Apache-2.0
#include "kernel/math/power.h"

#include <bit>
#include <cstdint>

namespace kerf {
namespace {

constexpr double kLn2 = 0.69314718055994530942;
constexpr int kExponentBits = 52, kBias = 1023;

/// Returns 2^n for a normal result.
double power_of_two(int n) {
  return std::bit_cast<double>(static_cast<std::uint64_t>(n + kBias) << kExponentBits);
}

/// Returns ln x by the series of artanh.
double logarithm(double x) {
  int halvings = static_cast<int>(std::bit_cast<std::uint64_t>(x) >> kExponentBits) - kBias;
  double mantissa = x / power_of_two(halvings);
  if (mantissa > 1.4142135623730951) {
    mantissa /= 2;
    ++halvings;
  }
  const double s = (mantissa - 1) / (mantissa + 1), s2 = s * s;
  double sum = 0;
  for (int k = 23; k > 0; k -= 2) sum = sum * s2 + 1.0 / k;
  return halvings * kLn2 + 2 * s * sum;
}

/// Returns e^y for |y| < 700.
double exponential(double y) {
  const double turns = y / kLn2;
  const int n = static_cast<int>(turns < 0 ? turns - 0.5 : turns + 0.5);
  const double r = y - n * kLn2;
  double sum = 1;
  for (int k = 17; k > 0; --k) sum = 1 + sum * r / k;
  return sum * power_of_two(n);
}

}  // namespace

double power(double base, double exponent) {
  return exponent == 0 ? 1 : exponential(exponent * logarithm(base));
}

}  // namespace kerf
