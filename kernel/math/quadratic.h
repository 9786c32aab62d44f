#pragma once

#include <cmath>

namespace kerf {

/// Roots of a t^2 + 2 b t + c = 0, first <= second where both are finite. No real root: NaN. A
/// vanishing leading coefficient leaves one root and one infinity, so it needs no special case: a
/// ramp of exactly the cone's angle is an ordinary ray here. Stable: neither root is a difference
/// of nearly equal numbers (W. Kahan). Branch-free, so that loops over columns vectorise.
struct QuadraticRoots {
  double first, second;
};
inline QuadraticRoots solve_quadratic(double a, double b, double c) {
  const double root = std::sqrt(b * b - a * c);
  const double q = b < 0 ? root - b : -b - root;
  const double t0 = q / a;
  const double t1 = c / q;
  // b = 0 and c = 0: q is 0, the double root is 0 (or every t, when a is 0 too: the NaN says that
  // no end is here).
  const double t2 = q == 0 ? t0 : t1;
  return {t2 < t0 ? t2 : t0, t2 < t0 ? t0 : t2};
}

}  // namespace kerf
