// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernel/piece/bounds.h"
#include "kernel/tool/tool.h"
#include "kernel/tool/tool_pose.h"

namespace kerf {

/// Returns the smallest box around the cylinder that encloses the whole tool, shank and holder
/// included, at a pose with a unit axis.
inline Bounds tool_bounds(const Tool& tool, const ToolPose& pose) {
  return cylinder_bounds({0, tool.whole_length_mm, tool.whole_radius_mm}, pose.tip_mm, pose.axis);
}

}  // namespace kerf
