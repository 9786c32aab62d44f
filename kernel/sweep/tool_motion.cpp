// SPDX-License-Identifier: Apache-2.0
#include "kernel/sweep/tool_motion.h"

#include "kernel/math/rotation.h"
#include "kernel/math/tolerance.h"

namespace kerf {

ToolPose ToolMotion::at(double share) const {
  if (share <= 0) return from;
  if (share >= 1) return to;
  return {from.tip_mm + (to.tip_mm - from.tip_mm) * share,
          great_circle(from.axis, to.axis, turn_rad, share)};
}

ToolMotion make_motion(const ToolPose& from, const ToolPose& to, double reach_mm) {
  ToolMotion motion{.from = from, .to = to};
  const Vec3 travel = to.tip_mm - from.tip_mm;
  motion.travel_mm = length(travel);
  motion.turn_rad = angle_between(from.axis, to.axis);
  if (motion.turn_rad < kParallelEpsilon) {
    motion.turn_rad = 0;
    motion.to.axis = from.axis;  // axes that differ by rounding are equal
  }
  const bool moves = motion.travel_mm > kRestEpsilonMm;
  if (motion.turn_rad == 0) {
    if (!moves) return motion;
    const double sine = length(cross(travel, from.axis)) / motion.travel_mm;
    motion.kind = sine < kAxialSine ? MotionKind::kAxial : MotionKind::kTranslation;
  } else {
    const bool turns_only = motion.travel_mm < kRotationShare * motion.turn_rad * reach_mm;
    motion.kind = turns_only ? MotionKind::kRotation : MotionKind::kGeneral;
  }
  return motion;
}

}  // namespace kerf
