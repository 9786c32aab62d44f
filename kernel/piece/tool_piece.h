// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <variant>

#include "kernel/piece/arc.h"
#include "kernel/piece/ball.h"
#include "kernel/piece/frustum.h"

namespace kerf {

/// A convex body of revolution about the tool's axis; heights in mm above the tip.
using ToolPiece = std::variant<BallPiece, FrustumPiece, ArcPiece>;

/// Returns the radius at a height of the axis, or kNoRadiusMm beyond the piece.
double radius_at(const ToolPiece& piece, double z_mm);

/// Returns the derivative of that radius by the height.
double slope_at(const ToolPiece& piece, double z_mm);

Extent extent(const ToolPiece& piece);

/// Returns a frustum around the piece with the same heights: the piece itself, or a cylinder.
FrustumPiece enclosing_frustum(const ToolPiece& piece);

/// Returns the part of a frustum or arc between two heights. Must not be called for a ball.
ToolPiece slice_of(const ToolPiece& piece, double z0_mm, double z1_mm);

/// A piece prepared for distance queries on lanes, where no variant can be visited.
struct PieceProfile {
  enum class Side { kLine, kArc, kBall };
  Side side;
  double z0_mm, z1_mm;     ///< heights of the ends
  FrustumSide line;        ///< for kLine
  double center_r_mm = 0;  ///< of the circle, for kArc and kBall
  double center_z_mm = 0;  ///< likewise
  double radius_mm = 0;    ///< likewise

  explicit PieceProfile(const ToolPiece& piece);

  /// Returns the signed distance from the side of a kLine.
  template <class Real>
  KERF_INLINE Real line_distance(Real rho_mm, Real h_mm) const {
    return line.distance(rho_mm, h_mm - z0_mm);
  }
  /// Returns the signed distance from the side of a kArc or kBall.
  template <class Real>
  KERF_INLINE CircleDistance<Real> arc_distance(Real rho_mm, Real h_mm) const {
    return circle_distance(center_r_mm, radius_mm, rho_mm, h_mm - center_z_mm);
  }
};

}  // namespace kerf
