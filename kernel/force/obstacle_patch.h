// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernel/force/contact_patch.h"
#include "kernel/force/obstacle.h"
#include "kernel/math/vec3.h"
#include "kernel/tool/convex_part.h"
#include "kernel/tool/tool_pose.h"

namespace kerf {

/// Returns the sum over the surface of a tool's part inside an obstacle, weighted by the square of
/// the depth, from `deepest_mm`, its deepest point, and about 230 points on circles of the part.
/// Only the deepest point counts if no other is inside; no weight if that is outside.
PatchSum obstacle_patch(const ConvexPart& part, const ToolPose& pose, const Obstacle& obstacle,
                        Vec3 deepest_mm);

}  // namespace kerf
