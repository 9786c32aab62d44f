// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "haptic_agent/servo/felt.h"
#include "tests/agent/stability/plant.h"
#include "tests/agent/stability/virtual_line.h"

namespace kerf::agent {

/// Settings: a hand of given mechanics cuts a slot of a ball of 6 mm, 2 mm deep, into a block from
/// its side, straight and then in a circle of 10 mm radius.
struct HeldCut {
  PlantMechanics mechanics{};
  LineQuality line{};
  double newtons = 1;  ///< of the whole slot
  double mm_per_s = 20;
  bool mechanistic = false;  ///< the law; otherwise specific_energy
};
struct HeldCutOutcome {
  /// What acts on the hand against what the server computes for the pose of that tick alone.
  FeltSums force, torque;
  double chatter_mm_per_s = 0;  ///< rms of the tip's velocity, less that of the hand's target
  double returned_mj = 0;       ///< most over any interval, in the plant
  std::uint64_t trips = 0;
};
HeldCutOutcome cut_by_hand(const HeldCut& cut);

}  // namespace kerf::agent
