// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "haptic_agent/servo/felt.h"
#include "tests/agent/stability/plant.h"
#include "tests/agent/stability/virtual_line.h"

namespace kerf::agent {

/// Settings: a hand of given mechanics cuts a slot with a ball of 6 mm, 2 mm deep, into a block
/// from its side, straight and then in half a circle.
struct HandHeldCut {
  PlantMechanics mechanics{};
  LineQuality line{};
  double newtons = 1;  ///< force of the whole slot
  double mm_per_s = 20;
  /// Radius of the circle, 10 to 30. A hand that the cut deflects by more than this cannot pull the
  /// tool around: it comes to rest in the middle. 1 N moves the tip by 13 mm in a hand of 0.5 N/mm
  /// that turns by 335 N mm/rad about a pivot 60 mm away.
  double radius_mm = 30;
  bool mechanistic = false;  ///< this law; otherwise specific_energy
};
struct HeldCutOutcome {
  /// The wrench acting on the hand against the server's for the pose of that tick alone.
  FeltSums force, torque;
  double chatter_mm_per_s = 0;  ///< rms of the tip's velocity minus that of the hand's target
  double returned_mj = 0;       ///< greatest over any interval, in the plant
  std::uint64_t trips = 0;
};
HeldCutOutcome cut_by_hand(const HandHeldCut& cut);

}  // namespace kerf::agent
