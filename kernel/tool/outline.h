// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <variant>
#include <vector>

#include "kernel/math/tolerance.h"
#include "kernel/tool/tool.h"

namespace kerf {

/// A straight section of the outline of a body of revolution. Sections are listed from the tip up.
/// A horizontal line is a shoulder.
struct OutlineLine {
  ProfilePoint from, to;
};
/// An arc that bulges away from the axis. It spans at most the half circle from bottom to top.
struct OutlineArc {
  ProfilePoint from, to;
  ProfilePoint center;
  double radius_mm;
};
using OutlineSection = std::variant<OutlineLine, OutlineArc>;

/// Returns the convex pieces of a body whose heights never fall along the outline. An arc that is
/// centered on the axis and starts at the tip becomes a whole ball where the next section covers
/// the rest of the ball.
std::vector<ToolPiece> pieces_of(const std::vector<OutlineSection>& outline);

}  // namespace kerf
