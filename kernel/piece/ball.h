// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernel/piece/circle.h"
#include "kernel/piece/extent.h"

namespace kerf {

/// A ball with its center on the tool's axis; heights in mm above the tip.
struct BallPiece {
  double center_mm, radius_mm;
  friend bool operator==(const BallPiece&, const BallPiece&) = default;
};

constexpr Extent extent(const BallPiece& p) {
  return {p.center_mm - p.radius_mm, p.center_mm + p.radius_mm, p.radius_mm};
}

/// Returns the radius at a height of the axis, or kNoRadiusMm beyond the ball.
template <class Real>
KERF_INLINE Real radius_at(const BallPiece& p, Real z_mm) {
  const Extent e = extent(p);
  return select((z_mm < e.z0_mm) | (z_mm > e.z1_mm), splat_like(z_mm, kNoRadiusMm),
                half_chord(p.radius_mm, z_mm - p.center_mm));
}

/// Returns the derivative of the radius by the height.
template <class Real>
KERF_INLINE Real slope_at(const BallPiece& p, Real z_mm) {
  return half_chord_slope(p.radius_mm, z_mm - p.center_mm);
}

/// Returns the signed distance of the point (ρ, h) and its gradient.
template <class Real>
KERF_INLINE CircleDistance<Real> side_distance(const BallPiece& p, Real rho_mm, Real h_mm) {
  return circle_distance(0, p.radius_mm, rho_mm, h_mm - p.center_mm);
}

}  // namespace kerf
