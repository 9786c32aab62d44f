// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "kernel/math/wrench.h"
#include "kernel/tool/tool_pose.h"

namespace kerf {

/// The surface of something that pushes a tool, near the place where it does, as a plane: enough to
/// go on feeling it while the tool moves a little (the intermediate representation of Adachi).
struct ContactPlane {
  Vec3 point_mm;        ///< where the tool is deepest
  Vec3 normal;          ///< unit, out of the surface
  double depth_mm = 0;  ///< of that place beyond the surface; below zero: a gap
  double stiffness_n_per_mm = 0;
  double radius_mm = 0;  ///< of validity around the place
  bool stock = false;    ///< the stock, not an obstacle
};

/// From this far the plane of something near is known before it is touched, mm. If it grows, planes
/// say less about what a curved obstacle is like there.
inline constexpr double kContactReachMm = 5;

/// F_collision and τ_collision of planes: stiffness x depth along each normal where the depth is
/// above zero, N and N·mm about the pivot, none about the axis itself.
Wrench wrench_of(std::span<const ContactPlane> planes, const ToolPose& pose, double pivot_mm);

}  // namespace kerf
