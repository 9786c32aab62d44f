// SPDX-License-Identifier: Apache-2.0
#include "kernel/force/tool_side.h"

#include <algorithm>
#include <limits>

#include "kernel/math/tolerance.h"

namespace kerf {
namespace {

constexpr double kFarAway = std::numeric_limits<double>::infinity();

/// Returns the radius of a piece at a height, which may be beyond its ends by rounding, or 0
/// farther away.
double radius_near(const ToolPiece& piece, double z_mm) {
  const Extent e = extent(piece);
  if (z_mm < e.z0_mm - kCoverEpsilonMm || z_mm > e.z1_mm + kCoverEpsilonMm) return 0;
  return radius_at(piece, std::clamp(z_mm, e.z0_mm, e.z1_mm));
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

}  // namespace kerf
