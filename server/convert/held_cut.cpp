// SPDX-License-Identifier: Apache-2.0
#include "server/convert/held_cut.h"

namespace kerf {

void HeldCut::add_motion(BatchSum& sum, const Sculpture& sculpture, const MoveTool& move,
                         const MotionResult& result) {
  if (move.from == move.to && held_.cutting.engaged_area_mm2 > 0) {
    return add_rest(sum, move.tool, move.to, result.collision, move.duration_s);
  }
  sum.add(result, move.duration_s);
  if (sculpture.settings().force.law != ForceLaw::kSpecificEnergy) return;
  held_ = {move.tool, move.to, result.wrench - result.collision, result.cutting};
}

void HeldCut::add_rest(BatchSum& sum, ToolId tool, const ToolPose& at, const Wrench& collision,
                       double duration_s) const {
  const bool holds = tool == held_.tool && at == held_.at && held_.cutting.engaged_area_mm2 > 0;
  MotionResult resting;
  resting.wrench = resting.collision = collision;
  if (holds) {
    resting.wrench = collision + held_.wrench;
    resting.cutting = held_.cutting;
  } else if (collision == Wrench{}) {
    return;
  }
  sum.add(resting, duration_s);
}

}  // namespace kerf
