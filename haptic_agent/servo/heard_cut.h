// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace kerf::agent {

/// Input of the sound for the newest tick (`../sound`).
struct HeardCut {
  /// The spindle turns: the pose is valid and the cutting button pressed.
  bool running = false;
  double force_n = 0;            ///< computed by the session, without guides
  double removed_mm3_per_s = 0;  ///< engaged area times the tip's speed
};

}  // namespace kerf::agent
