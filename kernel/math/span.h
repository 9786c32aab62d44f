// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>

#include "kernel/math/lanes.h"

namespace kerf {

/// Closed range of heights along a dexel ray (mm); empty where lo > hi.
struct Span {
  double lo = std::numeric_limits<double>::infinity();
  double hi = -std::numeric_limits<double>::infinity();
};

/// Ranges along eight rays.
struct LaneSpan {
  Lanes lo = Lanes(std::numeric_limits<double>::infinity());
  Lanes hi = Lanes(-std::numeric_limits<double>::infinity());
};

/// Widens `span` (a Span or a LaneSpan) to contain z where `hit` holds. Branch-free. A NaN is never
/// included, because its comparisons fail.
template <class AnySpan, class Condition, class Real>
KERF_INLINE void include(AnySpan& span, Condition hit, Real z) {
  span.lo = select(hit & (z < span.lo), z, span.lo);
  span.hi = select(hit & (z > span.hi), z, span.hi);
}

}  // namespace kerf
