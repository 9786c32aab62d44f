// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernel/math/lanes.h"

namespace kerf {

/// Roots of a t² + 2 b t + c = 0, first <= second where both are finite; NaN where there is no real
/// root.
template <class Real>
struct QuadraticRoots {
  Real first, second;
};

/// Solves a t² + 2 b t + c = 0. Real is double or Lanes. Numerically stable: neither root is a
/// difference of nearly equal numbers (W. Kahan). A vanishing leading coefficient gives one root
/// and one infinity, so a ramp at exactly the cone's angle is no special case. Branch-free, so that
/// loops over columns vectorize.
template <class Real>
KERF_INLINE QuadraticRoots<Real> solve_quadratic(Real a, Real b, Real c) {
  const Real root = square_root(b * b - a * c);
  const Real q = select(b < 0.0, root - b, -b - root);
  const Real t0 = q / a;
  const Real t1 = c / q;
  // b = 0 and c = 0: q is 0 and the double root is 0. If a is 0 too, every t is a root and both
  // results are NaN: the ray has no end here.
  const Real t2 = select(q == 0.0, t0, t1);
  return {select(t2 < t0, t2, t0), select(t2 < t0, t0, t2)};
}

}  // namespace kerf
