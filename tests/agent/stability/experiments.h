// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "haptic_agent/servo/servo_cycle.h"
#include "tests/agent/stability/virtual_line.h"

namespace kerf::agent {

/// A light hand that swings through fresh stock for some seconds.
struct Swing {
  ForceMode mode = ForceMode::kModel;
  LineQuality line{};
  double damping_n_s_per_m = 10;  ///< of the cut, where the tool is fully engaged
  double seconds = 3;
  bool copy = true;  ///< of the block near the tool, kept by the agent
};
struct SwingOutcome {
  double fastest_mm_per_s = 0;  ///< free motion reaches 190
  double returned_mj = 0;       ///< most over any interval
  double most_force_n = 0;
  bool active = false;  ///< force was shown when it ended
  std::uint64_t trips = 0;
  /// As in the research note: no faster than thrice the free motion, and no more energy returned
  /// than the tank holds.
  bool stable() const {
    return fastest_mm_per_s <= 600 && returned_mj <= PassivitySettings{}.tank_mj && trips == 0;
  }
};
SwingOutcome swing(const Swing& swing);

/// A path that a simulated hand took through a real block at no delay, with the server's force at
/// each tick.
struct Recording {
  std::vector<DeviceState> poses;
  std::vector<Vec3> force_n;
  /// Where somebody else cuts at each tick; empty: nobody does.
  std::vector<Vec3> another;
};
Recording record_carving(double seconds);
/// The same path while somebody else carves 2 mm beside where the hand will be in `ahead_s`: much
/// of what the hand comes to is gone, and was not when it was last heard of.
Recording beside_another(const Recording& recording, double ahead_s);

/// How far the shown force is from the server's at no delay along that path: rms of the difference
/// over rms of the force.
double force_error(const Recording& recording, ForceMode mode, const LineQuality& line, bool copy);

}  // namespace kerf::agent
