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
  pose.tip_mm = {sample.tip_mm[0], sample.tip_mm[1], sample.tip_mm[2]};
  pose.axis = {static_cast<double>(sample.axis[0]), static_cast<double>(sample.axis[1]),
               static_cast<double>(sample.axis[2])};
  if (!is_finite(pose.tip_mm)) return reject("the tip is not finite");
  if (!is_finite(pose.axis)) return reject("the axis is not finite");
  for (const double coordinate : sample.tip_mm) {
    if (std::abs(coordinate) > kCoordinateMaxMm) return reject("the tip is out of range");
  }
  if (std::abs(length(pose.axis) - 1) > wire::kAxisLengthTolerance) {
    return reject("the axis is not of unit length");
  }
  return admit_pose(pose);
}

wire::Vec3f to_wire_float(Vec3 value) {
  return {static_cast<float>(value.x), static_cast<float>(value.y), static_cast<float>(value.z)};
}
wire::Vec3d to_wire(Vec3 value) { return {value.x, value.y, value.z}; }

}  // namespace kerf
