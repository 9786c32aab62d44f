// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <variant>
#include <vector>

#include "kernel/math/tolerance.h"
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

/// The convex pieces of a body whose outline rises section by section (heights never fall). An arc
/// about a point of the axis that starts at the tip becomes a whole ball where what follows covers
/// the ball's rest.
std::vector<ToolPiece> pieces_of(const std::vector<OutlineSection>& outline);

}  // namespace kerf
