#pragma once

#include "kernel/math/quadratic.h"
#include "kernel/math/span.h"
#include "kernel/math/tolerance.h"
#include "kernel/math/vec3.h"

namespace kerf {

/// Dexel ray with the side of the cylinder of radius r around the segment from a to a + d: what a
/// sphere sweeps between its two ends. With p = (x, y, az + w) − a, the distance from the axis is r
/// where |p|² |d|² − (p·d)² = r² |d|²: A = dx² + dy², B = −k dz, C = (px² + py² − r²) |d|² − k², k
/// = px dx + py dy, A w² + 2 B w + C = 0; the foot (k + w dz) / |d|² must lie within the segment.
struct RayCylinder {
  Vec3 start, along;
  double radius2, length2, a, slack;

  RayCylinder(Vec3 from, Vec3 d, double radius)
      : start(from),
        along(d),
        radius2(radius * radius),
        length2(dot(d, d)),
        a(d.x * d.x + d.y * d.y),
        slack(kEdgeEpsilonMm * length(d)) {}

  void extend(Span& span, double x, double y) const {
    const double px = x - start.x, py = y - start.y;
    const double k = px * along.x + py * along.y;
    const double c = (px * px + py * py - radius2) * length2 - k * k;
    const QuadraticRoots w = solve_quadratic(a, -k * along.z, c);
    const double f0 = k + w.first * along.z, f1 = k + w.second * along.z;
    include(span, (f0 >= -slack) & (f0 <= length2 + slack), start.z + w.first);
    include(span, (f1 >= -slack) & (f1 <= length2 + slack), start.z + w.second);
  }
};

}  // namespace kerf
