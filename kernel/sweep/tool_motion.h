// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernel/sweep/motion_kind.h"
#include "kernel/tool/tool_pose.h"

namespace kerf {

/// A motion from one pose to the next, with what is asked of it again and again computed once.
struct ToolMotion {
  ToolPose from, to;
  double turn_rad = 0;   ///< angle between the axes
  double travel_mm = 0;  ///< path of the tip
  MotionKind kind = MotionKind::kRest;

  /// The pose at `share` (0..1) of the way: tip on a straight line, axis on the great circle, both
  /// uniformly.
  ToolPose at(double share) const;
};

/// Classifies the motion into the four cases of paper section 2.4. Axes must be unit and less than
/// 180 degrees apart; `reach_mm` (the tool's length) is what a turn is compared with.
ToolMotion make_motion(const ToolPose& from, const ToolPose& to, double reach_mm);

}  // namespace kerf
