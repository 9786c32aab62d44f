// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernel/sculpture.h"
#include "server/convert/batch_sum.h"

namespace kerf {

/// The cutting force of a participant's newest motion, which it keeps while its tool rests in the
/// cut.
///
/// The law `specific_energy` gives a force per travel, so a motion without travel has none,
/// although nothing has changed. A device that rounds its poses to 0.05 mm and moves at 2 mm/s
/// travels in one of 25 samples. Held over the other samples, the force does the work u V, whatever
/// the rounding. Under the other laws the force ends with the speed, and nothing is held.
class HeldCut {
 public:
  /// Adds the result of a motion to a sum, or, if the motion rests, the held force instead.
  /// `result` must have been felt.
  void add_motion(BatchSum& sum, const Sculpture& sculpture, const MoveTool& move,
                  const MotionResult& result);
  /// Adds the force over `duration_s` of rest at a pose: that of contacts, and the held one if the
  /// newest motion of this tool ended there.
  void add_rest(BatchSum& sum, ToolId tool, const ToolPose& at, const Wrench& collision,
                double duration_s) const;
  /// Ends the held force, because the tool stops cutting or stock has come back.
  void drop() { held_ = {}; }

 private:
  /// The cut alone, without contact, and the end of its motion.
  struct Held {
    ToolId tool = 0;
    ToolPose at;
    Wrench wrench;
    CuttingModel cutting;
  };
  Held held_;
};

}  // namespace kerf
