// SPDX-License-Identifier: Apache-2.0
#include "server/verify/obstacle_push.h"

#include <algorithm>
#include <cmath>

#include "kernel/math/rotation.h"

namespace kerf {
namespace {

constexpr double kStepMm = 0.5;

}  // namespace

double greatest_push_n(const Obstacles& obstacles, const Tool& tool, const ProgramMotion& motion,
                       double pivot_mm, int places_max) {
  const double turn_rad = angle_between(normalized(motion.from.axis), normalized(motion.to.axis));
  const double travel =
      length(motion.to.tip_mm - motion.from.tip_mm) + turn_rad * tool.whole_length_mm;
  const int steps = std::clamp(static_cast<int>(std::ceil(travel / kStepMm)), 1, places_max - 1);
  double worst = 0;
  for (int i = 0; i <= steps; ++i) {
    const ToolPose pose = pose_on(motion, static_cast<double>(i) / steps);
    worst = std::max(worst, length(obstacles.push(tool, pose, pivot_mm).force_n));
  }
  return worst;
}

}  // namespace kerf
