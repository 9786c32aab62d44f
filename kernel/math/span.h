#pragma once

#include <limits>

namespace kerf {

/// Closed range of heights along a dexel ray (mm); empty when lo > hi.
struct Span {
  double lo = std::numeric_limits<double>::infinity();
  double hi = -std::numeric_limits<double>::infinity();
};

/// Widens `span` to contain z where `hit` holds. Branch-free; a NaN never enters because its test
/// fails.
inline void include(Span& span, bool hit, double z) {
  span.lo = (hit & (z < span.lo)) ? z : span.lo;
  span.hi = (hit & (z > span.hi)) ? z : span.hi;
}

}  // namespace kerf
