// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernel/sweep/tool_motion.h"
#include "server/verify/box_tree.h"
#include "server/verify/tool_profile.h"

namespace kerf {

/// A tool on a motion: the tip moves on a straight line and the axis on a great circle, both
/// uniformly.
struct MovingTool {
  const ToolProfile* profile;
  ToolPose from, to;  ///< unit axes
  double turn_rad, travel_mm;

  /// Returns the pose at a fraction of the motion.
  ToolPose at(double share) const;
  /// Returns the box around all poses of a tool of this length and greatest radius.
  Box bounds(double length_mm, double radius_mm) const;
};

/// The pose of a motion at which a point is nearest to the tool, or deepest in it.
struct NearestPose {
  double share;  ///< fraction of the motion
  double mm;     ///< signed distance from the tool there, negative inside
};

/// Finds the nearest pose to a point, to 1e-6 mm along straight paths and about 1e-5 mm along
/// turning ones. Returns `best` unchanged if no pose is nearer than best.mm, and any pose nearer
/// than `enough_mm` as soon as one is found.
NearestPose nearest_pose(const MovingTool& tool, Vec3 point_mm, NearestPose best, double enough_mm);

/// Returns the direction in which the distance of a point from the tool at a pose grows; unit.
Vec3 outward_of(const ToolProfile& profile, const ToolPose& pose, Vec3 point_mm);

}  // namespace kerf
