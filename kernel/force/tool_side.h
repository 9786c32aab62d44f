// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

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

  /// The nearest point's signed distance (mm, negative inside), and the unit normal there.
  struct Nearest {
    double distance_mm;
    double radial, axial;
  };
  /// Returns the nearest surface at a distance from the axis and a height above the tip.
  Nearest at(double rho_mm, double h_mm) const;

 private:
  std::vector<CoveredPiece> pieces_;
};

}  // namespace kerf
