// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <limits>

#include "kernel/intersect/ray_pipe.h"
#include "kernel/math/lanes.h"
#include "kernel/math/tolerance.h"
#include "kernel/piece/bounds.h"

namespace kerf {

/// Rectangles of the XY plane around up to eight surfaces, enlarged by kRectangleMarginMm, so that
/// every ray that hits a surface is inside.
struct SurfaceRectangles {
  Lanes min_x, max_x, min_y, max_y;

  /// Starts with empty rectangles.
  SurfaceRectangles() {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    min_x = min_y = Lanes(kInfinity);
    max_x = max_y = Lanes(-kInfinity);
  }
  /// Includes a disc with the unit normal u in rectangle i, or a point if the radius is 0.
  void include(int i, Vec3 center, Vec3 u, double radius) {
    const double x = disc_half_width(radius, u.x) + kRectangleMarginMm;
    const double y = disc_half_width(radius, u.y) + kRectangleMarginMm;
    min_x.set(i, std::min(min_x[i], center.x - x));
    max_x.set(i, std::max(max_x[i], center.x + x));
    min_y.set(i, std::min(min_y[i], center.y - y));
    max_y.set(i, std::max(max_y[i], center.y + y));
  }
  void include(int i, const RayPipe& p) {
    include(i, p.center, p.normal, std::sqrt(p.radius2));
    include(i, p.center + p.along, p.normal, std::sqrt(p.radius2));
  }
  /// Returns the rectangles that overlap the range of x.
  KERF_INLINE LaneMask beside(double x0, double x1) const { return (min_x <= x1) & (max_x >= x0); }
  /// Returns a mask whose bit i is set if rectangle i, one of `beside`, contains y.
  KERF_INLINE unsigned over(LaneMask beside, double y) const {
    return bits(beside & (min_y <= y) & (max_y >= y));
  }
};

}  // namespace kerf
