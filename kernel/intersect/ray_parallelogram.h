// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernel/math/span.h"
#include "kernel/math/tolerance.h"
#include "kernel/math/vec3.h"

namespace kerf {

/// Intersection of a dexel ray with the parallelogram corner + α side + β along, with α and β in
/// [0, 1] (paper Eq. 13): two linear equations in x and y. A parallelogram that contains the ray's
/// direction is never hit, because other primitives cover its border curves.
struct RayParallelogram {
  Vec3 corner, side, along;
  double inverse_det, side_slack, along_slack;

  RayParallelogram(Vec3 p1, Vec3 side_mm, Vec3 along_mm)
      : corner(p1),
        side(side_mm),
        along(along_mm),
        inverse_det(1 / (side_mm.x * along_mm.y - side_mm.y * along_mm.x)),
        side_slack(kEdgeEpsilonMm / length(side_mm)),
        along_slack(kEdgeEpsilonMm / length(along_mm)) {}

  template <class AnySpan, class Real>
  KERF_INLINE void extend(AnySpan& span, Real x, Real y) const {
    const Real px = x - corner.x, py = y - corner.y;
    const Real alpha = (px * along.y - py * along.x) * inverse_det;
    const Real beta = (py * side.x - px * side.y) * inverse_det;
    const auto hit = (alpha >= -side_slack) & (alpha <= 1 + side_slack) & (beta >= -along_slack) &
                     (beta <= 1 + along_slack);
    include(span, hit, corner.z + alpha * side.z + beta * along.z);
  }
};

}  // namespace kerf
