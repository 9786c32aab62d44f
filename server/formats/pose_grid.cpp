// SPDX-License-Identifier: Apache-2.0
#include "server/formats/pose_grid.h"

#include <cmath>

namespace kerf {
namespace {

// Both steps are inverse powers of ten, so `scale` and the rounded product are exact integers and
// the quotient is the double nearest to the decimal. Adding zero turns -0 into +0: both are written
// as "0".
double to_grid(double value, double scale) { return std::round(value * scale) / scale + 0.0; }

constexpr double kTipScale = 1e6;
constexpr double kAxisScale = 1e9;
static_assert(kTipScale * kTipGridMm == 1 && kAxisScale * kAxisGrid == 1);

bool on_axis_grid(Vec3 u) {
  return std::abs(length(u) - 1) <= kAxisLengthTolerance && to_grid(u.x, kAxisScale) == u.x &&
         to_grid(u.y, kAxisScale) == u.y && to_grid(u.z, kAxisScale) == u.z;
}

Vec3 round_vector(Vec3 v, double scale) {
  return {to_grid(v.x, scale), to_grid(v.y, scale), to_grid(v.z, scale)};
}

}  // namespace

ToolPose admit_pose(const ToolPose& pose) {
  const Vec3 axis = on_axis_grid(pose.axis) ? pose.axis : normalized(pose.axis);
  return {round_vector(pose.tip_mm, kTipScale), round_vector(axis, kAxisScale)};
}

}  // namespace kerf
