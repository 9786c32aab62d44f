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

/// Returns why an obstacle is invalid (not finite, empty, stiffness not positive), or an empty
/// string.
std::string check_obstacle(const Obstacle& obstacle);

/// The obstacles of a scene, prepared for repeated queries (paper Eqs. 25, 26, for which the paper
/// gives no implementation).
class Obstacles {
 public:
  /// All obstacles must be valid (check_obstacle).
  explicit Obstacles(std::vector<Obstacle> obstacles);

  /// Computes F_collision (N) and τ_collision (N·mm) on the tool at a pose: the wrench of the union
  /// of its pieces, cutting or not, however they are divided. Each convex part is pushed out of
  /// each obstacle in the shortest direction by stiffness x depth of its deepest point. Parts that
  /// one obstacle pushes in one direction share the push of the deepest (BodyContact). The torque
  /// is about the point `pivot_mm` from the tip on the axis, without its component about the axis.
  /// Zero without contact.
  Wrench push(const Tool& tool, const ToolPose& pose, double pivot_mm) const;
  /// Appends the contact plane of each convex part with each obstacle nearer than kContactReachMm,
  /// at most BodyContact::kPlanesMax per obstacle. wrench_of these planes equals `push`.
  void planes(const Tool& tool, const ToolPose& pose, std::vector<ContactPlane>& out) const;

 private:
  struct Bounded {
    Obstacle obstacle;
    Vec3 center_mm;  ///< center of a sphere around the obstacle
    double radius_mm;
  };
  std::vector<Bounded> obstacles_;
};

}  // namespace kerf
