// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "haptic_agent/servo/felt.h"

namespace kerf::agent {

/// A straight cut into solid stock: down, along x, down by 1 in 3, and along x and y with a tool
/// that leans by 0.3 rad.
enum class StraightCut : std::uint8_t { kPlunge, kSlot, kRamp, kTilted };
inline constexpr StraightCut kStraightCuts[] = {StraightCut::kPlunge, StraightCut::kSlot,
                                                StraightCut::kRamp, StraightCut::kTilted};
const char* name_of(StraightCut cut) noexcept;

/// Settings: a flat end mill of 6 mm moves along a straight path at an even speed, held by a rigid
/// hand. Only the pose that the device reports is rounded.
struct EncoderCut {
  StraightCut path = StraightCut::kSlot;
  double mm_per_s = 20;
  double quantum_mm = 0, quantum_rad = 0;  ///< for each coordinate of tip and axis
  bool declared = true;                    ///< whether the device states its quanta
  bool falcon = false;  ///< a Falcon with its driver: rounds the angles of its legs
  const char* law = "specific_energy";
  const char* rays = "dexel";
};
struct EncoderCutOutcome {
  /// Shown force and torque against those of the same path without rounding: means of the
  /// magnitudes, and the difference of the vectors. Starts max(2 quanta of travel, 10 ms) after the
  /// cut.
  FeltSums force, torque;
  /// Volume removed by the rounded path, relative to the exact one.
  double removed_share = 0;
};
EncoderCutOutcome cut_by_encoder(const EncoderCut& cut);

}  // namespace kerf::agent
