// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernel/math/vec3.h"

namespace kerf {

/// Position of a tool's tip (mm) and its unit axis, which points from the tip to the spindle (APT
/// i, j, k). Five degrees of freedom: a turn about its axis does not change a tool of revolution.
struct ToolPose {
  Vec3 tip_mm;
  Vec3 axis{0, 0, 1};
  friend constexpr bool operator==(const ToolPose&, const ToolPose&) = default;
};

}  // namespace kerf
