// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "kernel/math/lanes.h"
#include "kernel/piece/extent.h"

namespace kerf {

/// Truncated cone between two discs, z0 < z1: r0 == r1 is a cylinder, r0 == 0 a pointed cone.
/// Heights in mm above the tip.
struct FrustumPiece {
  double z0_mm, r0_mm, z1_mm, r1_mm;
  friend bool operator==(const FrustumPiece&, const FrustumPiece&) = default;
};

constexpr Extent extent(const FrustumPiece& p) {
  return {p.z0_mm, p.z1_mm, p.r0_mm < p.r1_mm ? p.r1_mm : p.r0_mm};
}

/// Returns the derivative of the radius by the height: k in r0 + k (z − z0).
constexpr double slope(const FrustumPiece& p) { return (p.r1_mm - p.r0_mm) / (p.z1_mm - p.z0_mm); }
template <class Real>
KERF_INLINE Real slope_at(const FrustumPiece& p, Real z_mm) {
  return splat_like(z_mm, slope(p));
}

/// Returns the radius at a height of the axis, or kNoRadiusMm beyond the discs.
template <class Real>
KERF_INLINE Real radius_at(const FrustumPiece& p, Real z_mm) {
  const Real inside = p.r0_mm + (p.r1_mm - p.r0_mm) * ((z_mm - p.z0_mm) / (p.z1_mm - p.z0_mm));
  return select((z_mm < p.z0_mm) | (z_mm > p.z1_mm), splat_like(z_mm, kNoRadiusMm), inside);
}

/// The side of a frustum, continued beyond its discs. Its unit normal in the half-plane (ρ, h) is
/// (cosine, −slope · cosine) everywhere.
struct FrustumSide {
  double r0_mm = 0;   ///< radius of the lower disc
  double slope = 0;   ///< derivative of the radius by the height
  double cosine = 1;  ///< of the angle between side and axis

  FrustumSide() = default;
  explicit FrustumSide(const FrustumPiece& p)
      : r0_mm(p.r0_mm), slope(kerf::slope(p)), cosine(1 / std::sqrt(1 + slope * slope)) {}

  /// Returns the signed distance, negative inside, of the point at the distance ρ from the axis and
  /// the height `above` above the lower disc.
  template <class Real>
  KERF_INLINE Real distance(Real rho_mm, Real above_mm) const {
    return (rho_mm - r0_mm - slope * above_mm) * cosine;
  }
};

}  // namespace kerf
