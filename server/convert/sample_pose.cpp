// SPDX-License-Identifier: Apache-2.0
#include "server/convert/sample_pose.h"

#include <cmath>
#include <string>

#include "kernel/sculpture.h"
#include "server/formats/pose_grid.h"
#include "server/wire/limits.h"

namespace kerf {

std::expected<ToolPose, Rejection> to_pose(const wire::MotionSample& sample) {
  const auto reject = [&](const char* reason) {
    return std::unexpected(sample_rejection(sample, wire::ErrorCode::kBadPose, reason));
  };
  ToolPose pose;
  pose.tip_mm = sample.tip_mm;
  pose.axis = Vec3(sample.axis);
  if (!is_finite(pose.tip_mm)) return reject("the tip must be finite");
  if (!is_finite(pose.axis)) return reject("the axis must be finite");
  for (const double coordinate : {pose.tip_mm.x, pose.tip_mm.y, pose.tip_mm.z}) {
    if (std::abs(coordinate) > kCoordinateMaxMm)
      return reject("tip coordinates must be between -1e6 and 1e6 mm");
  }
  if (std::abs(length(pose.axis) - 1) > wire::kAxisLengthTolerance) {
    return reject("the axis must have unit length");
  }
  return admit_pose(pose);
}

}  // namespace kerf
