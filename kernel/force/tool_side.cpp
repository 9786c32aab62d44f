// SPDX-License-Identifier: Apache-2.0
#include "kernel/force/tool_side.h"

#include <algorithm>
#include <limits>

#include "kernel/math/tolerance.h"

namespace kerf {
namespace {

constexpr double kFarAway = std::numeric_limits<double>::infinity();

/// Returns the radius of a piece at a height, which may be beyond its ends by rounding; 0 farther
/// away.
double radius_near(const ToolPiece& piece, double z_mm) {
  const Extent e = extent(piece);
  if (z_mm < e.z0_mm - kCoverEpsilonMm || z_mm > e.z1_mm + kCoverEpsilonMm) return 0;
  return radius_at(piece, std::clamp(z_mm, e.z0_mm, e.z1_mm));
}

/// Returns the side of a piece that is nearest, without its discs.
ToolSide::Nearest side_of(const PieceProfile& piece, double rho_mm, double h_mm) {
  if (piece.side == PieceProfile::Side::kLine) {
    return {piece.line_distance(rho_mm, h_mm), piece.line.cosine,
            -piece.line.slope * piece.line.cosine};
  }
  const CircleDistance<double> d = piece.arc_distance(rho_mm, h_mm);
  if (!(d.length > 0)) return {d.mm, 1, 0};
  return {d.mm, d.across / d.length, d.along / d.length};
}

}  // namespace

std::vector<CoveredPiece> covered_pieces(const Tool& tool) {
  std::vector<CoveredPiece> pieces;
  pieces.reserve(tool.pieces.size());
  for (const ToolPiece& piece : tool.pieces) {
    const Extent e = extent(piece);
    double below = 0, above = 0;
    for (const ToolPiece& other : tool.pieces) {
      if (&other == &piece) continue;
      below = std::max(below, radius_near(other, e.z0_mm));
      above = std::max(above, radius_near(other, e.z1_mm));
    }
    const bool hides_below = below > radius_at(piece, e.z0_mm) - kCoverEpsilonMm;
    const bool hides_above = above > radius_at(piece, e.z1_mm) - kCoverEpsilonMm;
    pieces.push_back({PieceProfile(piece), hides_below ? kFarAway : below * below,
                      hides_above ? kFarAway : above * above});
  }
  return pieces;
}

ToolSide::Nearest ToolSide::at(double rho_mm, double h_mm) const {
  Nearest nearest{kFarAway, 1, 0};
  for (const CoveredPiece& p : pieces_) {
    const double below = p.profile.z0_mm - h_mm, above = h_mm - p.profile.z1_mm;
    if (std::max(below, above) >= nearest.distance_mm) continue;
    Nearest face = side_of(p.profile, rho_mm, h_mm);
    const double distance = std::max({face.distance_mm, below, above});
    if (distance >= nearest.distance_mm) continue;
    if (below > face.distance_mm && rho_mm * rho_mm > p.covered_below2) face = {below, 0, -1};
    if (above > face.distance_mm && rho_mm * rho_mm > p.covered_above2) face = {above, 0, 1};
    nearest = {distance, face.radial, face.axial};
  }
  return nearest;
}

}  // namespace kerf
