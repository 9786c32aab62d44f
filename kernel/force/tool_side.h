// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "kernel/math/lanes.h"
#include "kernel/tool/tool.h"

namespace kerf {

/// A piece of a tool, and the radii up to which other pieces cover the discs at its ends. Beyond
/// these radii the discs bound the tool.
struct CoveredPiece {
  PieceProfile profile;
  double covered_below2, covered_above2;  ///< squares of those radii
};
std::vector<CoveredPiece> covered_pieces(const Tool& tool);

/// The surface of a tool's cutting part, in its half-plane of radius and height.
class ToolSide {
 public:
  explicit ToolSide(const Tool& tool) : pieces_(covered_pieces(tool)) {}

  /// The nearest points' signed distances (mm, negative inside), and the unit normals there.
  struct Nearest {
    Lanes distance_mm, radial, axial;
  };
  /// Returns the nearest surface at distances from the axis and heights above the tip.
  KERF_INLINE Nearest at(const Lanes& rho_mm, const Lanes& h_mm) const;

 private:
  /// Returns the side of a piece that is nearest, without its discs.
  KERF_INLINE static Nearest side_of(const PieceProfile& piece, const Lanes& rho_mm,
                                     const Lanes& h_mm);

  std::vector<CoveredPiece> pieces_;
};

KERF_INLINE ToolSide::Nearest ToolSide::side_of(const PieceProfile& piece, const Lanes& rho_mm,
                                                const Lanes& h_mm) {
  if (piece.side == PieceProfile::Side::kLine) {
    return {piece.line_distance(rho_mm, h_mm), piece.line.cosine,
            -piece.line.slope * piece.line.cosine};
  }
  const CircleDistance<Lanes> d = piece.arc_distance(rho_mm, h_mm);
  const LaneMask beside = d.length > 0.0;
  const Lanes scale = 1.0 / d.length;
  return {d.mm, select(beside, d.across * scale, Lanes(1)),
          select(beside, d.along * scale, Lanes())};
}

KERF_INLINE ToolSide::Nearest ToolSide::at(const Lanes& rho_mm, const Lanes& h_mm) const {
  Nearest nearest{Lanes(__builtin_inf()), Lanes(1), Lanes()};
  const Lanes rho2 = rho_mm * rho_mm;
  for (const CoveredPiece& p : pieces_) {
    const Lanes below = p.profile.z0_mm - h_mm, above = h_mm - p.profile.z1_mm;
    if (!any(greater(below, above) < nearest.distance_mm)) continue;
    const Nearest face = side_of(p.profile, rho_mm, h_mm);
    const Lanes distance = greater(face.distance_mm, greater(below, above));
    const LaneMask nearer = distance < nearest.distance_mm;
    const LaneMask lower = (below > face.distance_mm) & (rho2 > p.covered_below2);
    const LaneMask upper = (above > face.distance_mm) & (rho2 > p.covered_above2);
    const LaneMask disc = lower | upper;
    const Lanes radial = select(disc, Lanes(), face.radial);
    const Lanes axial = select(upper, Lanes(1), select(lower, Lanes(-1), face.axial));
    nearest.distance_mm = select(nearer, distance, nearest.distance_mm);
    nearest.radial = select(nearer, radial, nearest.radial);
    nearest.axial = select(nearer, axial, nearest.axial);
  }
  return nearest;
}

}  // namespace kerf
