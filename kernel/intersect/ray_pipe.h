// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernel/math/quadratic.h"
#include "kernel/math/span.h"
#include "kernel/math/tolerance.h"
#include "kernel/math/vec3.h"

namespace kerf {

/// Intersection of a dexel ray with the pipe that a circle sweeps along a straight line (paper Eqs.
/// 14–17): center c, unit normal u, radius r, moved by d.
///
/// Eq. 17 divides by the motion's component along the normal, d·u, which is 0 for the most common
/// motion, an upright tool moved horizontally. This form avoids the division. The point at height
/// cz + w in the plane of the circle at share s satisfies α + uz w = s (d·u), α = px ux + py uy.
/// This line in the (s, w) plane, (s, w) = −α (−du, uz) / n + τ (uz, du), n = uz² + du², has no
/// singular direction. Relative to the moved center its point is q(τ) = q0 + τ g, g = du ẑ − uz d,
/// and |q|² = r² is quadratic in τ. If g = 0 the circle moves along the ray. Then the circle's
/// start and end bound the swept volume instead of the pipe.
struct RayPipe {
  Vec3 center, normal, along, g;
  double radius2, du, inverse_n, a, slack;

  RayPipe(Vec3 center_mm, Vec3 unit_normal, double radius_mm, Vec3 along_mm)
      : center(center_mm),
        normal(unit_normal),
        along(along_mm),
        g{-unit_normal.z * along_mm.x, -unit_normal.z * along_mm.y,
          unit_normal.x * along_mm.x + unit_normal.y * along_mm.y},
        radius2(radius_mm * radius_mm),
        du(dot(along_mm, unit_normal)),
        inverse_n(1 / (unit_normal.z * unit_normal.z + du * du)),
        a(dot(g, g)),
        slack(kEdgeEpsilonMm / length(along_mm)) {}

  template <class AnySpan, class Real>
  KERF_INLINE void extend(AnySpan& span, Real x, Real y) const {
    const Real px = x - center.x, py = y - center.y;
    const Real alpha = (px * normal.x + py * normal.y) * inverse_n;
    const Real s0 = alpha * du, w0 = -alpha * normal.z;
    const Real qx = px - s0 * along.x, qy = py - s0 * along.y, qz = w0 - s0 * along.z;
    const auto tau = solve_quadratic(splat_like(x, a), qx * g.x + qy * g.y + qz * g.z,
                                     qx * qx + qy * qy + qz * qz - radius2);
    const Real s1 = s0 + tau.first * normal.z, s2 = s0 + tau.second * normal.z;
    include(span, (s1 >= -slack) & (s1 <= 1 + slack), center.z + w0 + tau.first * du);
    include(span, (s2 >= -slack) & (s2 <= 1 + slack), center.z + w0 + tau.second * du);
  }
};

}  // namespace kerf
