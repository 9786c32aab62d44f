// SPDX-License-Identifier: Apache-2.0
#include "server/convert/sample_pose.h"

#include <cmath>
#include <string>

#include "kernel/sculpture.h"
#include "server/formats/pose_grid.h"
#include "server/wire/limits.h"

namespace kerf {

std::expected<ToolPose, Rejection> to_pose(const wire::MotionSample& sample) {
  const auto reject = [&](const char* what) {
    return std::unexpected(
        Rejection{wire::ErrorCode::kBadPose,
                  "sample " + std::to_string(sample.agent_sequence) + ": " + what});
  };
  ToolPose pose;
  pose.tip_mm = sample.tip_mm;
  pose.axis = Vec3(sample.axis);
  if (!is_finite(pose.tip_mm)) return reject("the tip is not finite");
  if (!is_finite(pose.axis)) return reject("the axis is not finite");
  for (const double coordinate : {pose.tip_mm.x, pose.tip_mm.y, pose.tip_mm.z}) {
    if (std::abs(coordinate) > kCoordinateMaxMm) return reject("the tip is out of range");
  }
  if (std::abs(length(pose.axis) - 1) > wire::kAxisLengthTolerance) {
    return reject("the axis is not of unit length");
  }
  return admit_pose(pose);
}

}  // namespace kerf
