// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernel/sweep/motion_kind.h"
#include "kernel/tool/tool_pose.h"

namespace kerf {

/// A motion from one pose to the next, with its kind, turn and travel.
struct ToolMotion {
  ToolPose from, to;
  double turn_rad = 0;   ///< angle between the axes
  double travel_mm = 0;  ///< length of the tip's path
  MotionKind kind = MotionKind::kRest;

  /// Returns the pose at `share` (0..1) of the motion: the tip on a straight line, the axis on the
  /// great circle, both uniform.
  ToolPose at(double share) const;
};

/// Makes a motion and classifies it into the four cases of paper section 2.4. Axes must be of unit
/// length and less than 180 degrees apart. `reach_mm` is the tool's length: a turn by it is
/// compared with the tip's path.
ToolMotion make_motion(const ToolPose& from, const ToolPose& to, double reach_mm);

}  // namespace kerf
