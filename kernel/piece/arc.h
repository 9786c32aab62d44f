// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

#include "kernel/piece/circle.h"
#include "kernel/piece/extent.h"

namespace kerf {

/// A convex body of revolution between the heights z0 < z1, whose profile is the outer side of the
/// arc of radius `radius` about (center_r, center_z) in the half-plane (ρ, h). The radius at height
/// z is center_r + √(radius² − (z − center_z)²), nowhere negative. center_r > 0 is the corner of a
/// bull-nose, center_r < 0 the flank of a barrel, 0 a slice of a ball. Heights in mm above the tip.
struct ArcPiece {
  double center_r_mm, center_z_mm, radius_mm, z0_mm, z1_mm;
  friend bool operator==(const ArcPiece&, const ArcPiece&) = default;
};

/// Returns the radius at a height of the axis, or kNoRadiusMm beyond the discs.
template <class Real>
KERF_INLINE Real radius_at(const ArcPiece& p, Real z_mm) {
  const Real inside = p.center_r_mm + half_chord(p.radius_mm, z_mm - p.center_z_mm);
  return select((z_mm < p.z0_mm) | (z_mm > p.z1_mm), splat_like(z_mm, kNoRadiusMm),
                greater(inside, splat_like(z_mm, 0)));
}

/// Return whether the side meets the lower or upper disc tangentially. The disc then continues the
/// side without an edge, and the body is the same without it.
constexpr bool is_level_below(const ArcPiece& p) {
  return p.center_r_mm >= 0 && p.z0_mm <= p.center_z_mm - p.radius_mm;
}
constexpr bool is_level_above(const ArcPiece& p) {
  return p.center_r_mm >= 0 && p.z1_mm >= p.center_z_mm + p.radius_mm;
}

/// The radius is greatest at the height of the center, or at the end nearest to it.
inline Extent extent(const ArcPiece& p) {
  return {p.z0_mm, p.z1_mm, radius_at(p, std::clamp(p.center_z_mm, p.z0_mm, p.z1_mm))};
}

/// Returns the derivative of the radius by the height.
template <class Real>
KERF_INLINE Real slope_at(const ArcPiece& p, Real z_mm) {
  return half_chord_slope(p.radius_mm, z_mm - p.center_z_mm);
}

/// Returns the signed distance of the point (ρ, h) from the side, continued beyond the discs, and
/// its gradient.
template <class Real>
KERF_INLINE CircleDistance<Real> side_distance(const ArcPiece& p, Real rho_mm, Real h_mm) {
  return circle_distance(p.center_r_mm, p.radius_mm, rho_mm, h_mm - p.center_z_mm);
}

}  // namespace kerf
