// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernel/math/lanes.h"

namespace kerf {

/// Roots of a t^2 + 2 b t + c = 0, first <= second where both are finite. No real root: NaN. A
/// vanishing leading coefficient leaves one root and one infinity, so it needs no special case: a
/// ramp of exactly the cone's angle is an ordinary ray here. Stable: neither root is a difference
/// of nearly equal numbers (W. Kahan). Branch-free, so that loops over columns vectorise.
/// Real is double or Lanes.
template <class Real>
struct QuadraticRoots {
  Real first, second;
};
template <class Real>
KERF_INLINE QuadraticRoots<Real> solve_quadratic(Real a, Real b, Real c) {
  const Real root = square_root(b * b - a * c);
  const Real q = select(b < 0.0, root - b, -b - root);
  const Real t0 = q / a;
  const Real t1 = c / q;
  // b = 0 and c = 0: q is 0, the double root is 0 (or every t, when a is 0 too: the NaN says that
  // no end is here).
  const Real t2 = select(q == 0.0, t0, t1);
  return {select(t2 < t0, t2, t0), select(t2 < t0, t0, t2)};
}

}  // namespace kerf
