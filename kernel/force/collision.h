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

/// Returns what is invalid in an obstacle (not finite, empty, stiffness not positive), or an empty
/// string.
std::string check_obstacle(const Obstacle& obstacle);

/// The obstacles of a scene, prepared for repeated queries: F_collision and τ_collision of paper
/// Eqs. 25–26, for which the paper gives no formula.
class Obstacles {
 public:
  /// All obstacles must have passed check_obstacle.
  explicit Obstacles(std::vector<Obstacle> obstacles);

  /// Returns F_collision and τ_collision on the tool at a pose: each convex piece, cutting or not,
  /// is pushed out of each obstacle along the shortest path, by stiffness × depth of its deepest
  /// point. The torque is about `pivot_mm` up the axis, without a component about the axis itself.
  /// Zero when nothing touches.
  Wrench push(const Tool& tool, const ToolPose& pose, double pivot_mm) const;
  /// Appends the contact plane of each convex piece with each obstacle that is nearer than
  /// kContactReachMm. `wrench_of` these planes equals push.
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
