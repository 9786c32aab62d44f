// SPDX-License-Identifier: Apache-2.0
#include "server/convert/held_cut.h"

namespace kerf {

void HeldCut::add_motion(BatchSum& sum, const Sculpture& sculpture, const MoveTool& move,
                         const MotionResult& result) {
  const bool rests = move.from == move.to;
  if (rests && held_.cutting.engaged_area_mm2 > 0) {
    MotionResult resting;
    resting.collision = result.collision;
    resting.wrench = held_.wrench + result.collision;
    resting.cutting = held_.cutting;
    sum.add(resting, move.duration_s);
    return;
  }
  sum.add(result, move.duration_s);
  if (sculpture.settings().force.law != ForceLaw::kSpecificEnergy) return;
  held_ = {result.wrench - result.collision, result.cutting};
}

void HeldCut::add_rest(BatchSum& sum, double duration_s) const {
  if (!(held_.cutting.engaged_area_mm2 > 0)) return;
  MotionResult resting;
  resting.wrench = held_.wrench;
  resting.cutting = held_.cutting;
  sum.add(resting, duration_s);
}

}  // namespace kerf
