// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <variant>
#include <vector>

#include "kernel/tool/tool.h"

namespace kerf {

/// The outline of a body of revolution, section by section from the tip up. A horizontal line is a
/// shoulder and bounds the sections beside it.
struct OutlineLine {
  ProfilePoint from, to;
};
/// An arc that bulges away from the axis, at most from the bottom of its circle to the top.
struct OutlineArc {
  ProfilePoint from, to;
  ProfilePoint center;
  double radius_mm;
};
using OutlineSection = std::variant<OutlineLine, OutlineArc>;

/// mm. Sections that rise by less are shoulders; what should meet the axis or be tangent and misses
/// by less, does. Owner: kernel/tool. If it grows, thin parts of a profile are lost.
inline constexpr double kOutlineEpsilonMm = 1e-9;

/// The convex pieces of a body whose outline rises section by section (heights never fall). An arc
/// about a point of the axis that starts at the tip becomes a whole ball where what follows covers
/// the ball's rest.
std::vector<ToolPiece> pieces_of(const std::vector<OutlineSection>& outline);

}  // namespace kerf
