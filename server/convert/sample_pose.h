// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <expected>

#include "kernel/tool/tool_pose.h"
#include "server/convert/rejection.h"
#include "server/wire/types.h"

namespace kerf {

/// The pose of a sample, checked (finite, in range, unit axis) and put on the pose grid, so that
/// every cut of the session can be written into a program and carved again alike.
std::expected<ToolPose, Rejection> to_pose(const wire::MotionSample& sample);

}  // namespace kerf
