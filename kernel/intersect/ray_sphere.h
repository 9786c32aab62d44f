#pragma once

#include <cmath>

#include "kernel/math/span.h"
#include "kernel/math/vec3.h"

namespace kerf {

/// Dexel ray with a sphere: (x − cx)² + (y − cy)² + w² = r², z = cz + w (paper section 2.4,
/// intersection 1). A dexel ray is the line along +Z through (x, y); every primitive of this room
/// adds the heights at which the ray meets it to a Span, and nothing when it misses.
struct RaySphere {
  Vec3 center;
  double radius2;  ///< radius squared

  void extend(Span& span, double x, double y) const {
    const double px = x - center.x, py = y - center.y;
    const double w = std::sqrt(radius2 - px * px - py * py);  // NaN: a miss
    include(span, w >= 0, center.z - w);
    include(span, w >= 0, center.z + w);
  }
};

}  // namespace kerf
