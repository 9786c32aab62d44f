// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernel/force/contact_patch.h"
#include "kernel/force/obstacle.h"
#include "kernel/math/vec3.h"
#include "kernel/tool/convex_part.h"
#include "kernel/tool/tool_pose.h"

namespace kerf {

/// Returns the sum over the surface of a tool's part inside an obstacle, weighted by the square of
/// the depth. It covers `deepest_mm`, the part's deepest point, and about 230 points on circles of
/// the part. If no other point is inside, only the deepest counts. If that is outside, there is no
/// weight.
PatchSum obstacle_patch(const ConvexPart& part, const ToolPose& pose, const Obstacle& obstacle,
                        Vec3 deepest_mm);

}  // namespace kerf
