// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "kernel/force/contact_plane.h"
#include "kernel/force/obstacle.h"
#include "kernel/math/wrench.h"
#include "kernel/tool/tool.h"
#include "kernel/tool/tool_pose.h"

namespace kerf {

/// What is wrong with an obstacle (not finite, empty, stiffness not positive), or nothing.
std::string check_obstacle(const Obstacle& obstacle);

/// The obstacles of a scene, prepared for one query after the other (paper Eqs. 25–26, which the
/// paper left out).
class Obstacles {
 public:
  /// All obstacles must have passed check_obstacle.
  explicit Obstacles(std::vector<Obstacle> obstacles);

  /// F_collision and τ_collision on the tool at a pose: each convex piece, cutting or
  /// not, is pushed out of each
  /// obstacle along the shortest way by stiffness x depth of its deepest point; torque about
  /// `pivot_mm` up the axis, none about the axis itself. Zero when nothing touches.
  Wrench push(const Tool& tool, const ToolPose& pose, double pivot_mm) const;
  /// Appends the plane of each convex piece against each obstacle that is nearer than
  /// kContactReachMm; wrench_of them is push.
  void planes(const Tool& tool, const ToolPose& pose, std::vector<ContactPlane>& out) const;

 private:
  struct Bounded {
    Obstacle obstacle;
    Vec3 center_mm;  ///< of a sphere around the obstacle
    double radius_mm;
  };
  std::vector<Bounded> obstacles_;
};

}  // namespace kerf
