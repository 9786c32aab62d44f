// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <expected>

#include "kernel/tool/tool_pose.h"
#include "server/convert/rejection.h"
#include "server/wire/types.h"

namespace kerf {

/// Returns the pose of a sample, checked (finite, in range, unit axis) and rounded to the pose
/// grid, so that every motion of a session can be exported as a program and carved again
/// identically.
std::expected<ToolPose, Rejection> to_pose(const wire::MotionSample& sample);

}  // namespace kerf
