// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernel/math/quadratic.h"
#include "kernel/math/span.h"
#include "kernel/math/tolerance.h"
#include "kernel/math/vec3.h"
#include "kernel/piece/frustum.h"

namespace kerf {

/// Intersection of a dexel ray with a solid frustum (paper Eq. 2; a cylinder when the slope is 0):
/// lower disc of radius r0 about `base`, upper disc at height H along the unit axis u, radius
/// r0 + k l at height l. With p = (x, y, base.z + w) − base and l = α + uz w, α = px ux + py uy,
/// the side is |p|² − l² = (r0 + k l)²: A = 1 − (1 + k²) uz², B = −((1 + k²) α + r0 k) uz, C = px²
/// + py² − (1 + k²) α² − 2 r0 k α − r0². The discs are l = 0 and l = H with |p|² − l² ≤ radius².
struct RayCone {
  Vec3 base, axis;
  double height, r0, slope, r0_sq, r1_sq, a, inverse_uz;

  RayCone(const FrustumPiece& p, Vec3 tip_mm, Vec3 unit_axis)
      : base(tip_mm + unit_axis * p.z0_mm),
        axis(unit_axis),
        height(p.z1_mm - p.z0_mm),
        r0(p.r0_mm),
        slope(kerf::slope(p)),
        r0_sq(p.r0_mm * p.r0_mm),
        r1_sq(p.r1_mm * p.r1_mm),
        a(axis.x * axis.x + axis.y * axis.y - slope * slope * axis.z * axis.z),
        inverse_uz(1 / axis.z) {}

  template <class AnySpan, class Real>
  KERF_INLINE void extend(AnySpan& span, Real x, Real y) const {
    const Real px = x - base.x, py = y - base.y;
    const Real alpha = px * axis.x + py * axis.y;
    const Real p2 = px * px + py * py;
    const double k1 = 1 + slope * slope;
    const Real b = -(k1 * alpha + r0 * slope) * axis.z;
    const Real c = p2 - k1 * alpha * alpha - 2 * r0 * slope * alpha - r0_sq;
    const auto w = solve_quadratic(splat_like(x, a), b, c);
    const Real l0 = alpha + axis.z * w.first, l1 = alpha + axis.z * w.second;
    include(span, (l0 >= -kEdgeEpsilonMm) & (l0 <= height + kEdgeEpsilonMm), base.z + w.first);
    include(span, (l1 >= -kEdgeEpsilonMm) & (l1 <= height + kEdgeEpsilonMm), base.z + w.second);
    // For an axis at right angles to the ray these are infinite or NaN: no disc is hit.
    const Real d0 = -alpha * inverse_uz, d1 = (height - alpha) * inverse_uz;
    include(span, p2 + d0 * d0 <= r0_sq, base.z + d0);
    include(span, p2 + d1 * d1 - height * height <= r1_sq, base.z + d1);
  }
};

}  // namespace kerf
