// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "tests/agent/stability/plant.h"
#include "tests/agent/stability/virtual_line.h"

namespace kerf::agent {

/// The cause of the stock around the tool: its stroke is undone and redone, or a ball of 10 mm
/// replaces one of 6 mm and vice versa, every 0.4 s.
enum class Surrounding : std::uint8_t { kNothing, kUndo, kLargerTool };

/// Settings: a hand cuts a slot of 3 mm depth with a ball or an end mill of 6 mm. Then stock
/// appears around the tool while the hand moves to and fro in the slot, then rests.
struct Surround {
  PlantMechanics mechanics{};
  LineQuality line{};
  Surrounding by = Surrounding::kUndo;
  bool cutting = false;      ///< the cutting button stays pressed; else only for the slot
  bool loses_ticks = false;  ///< four in a row, 2 % in all
  bool flat = false;         ///< an end mill instead of the ball
  double force_n_per_mm2 = 0.1;
  double swing_mm = 4, swing_s = 1.8;  ///< to and fro, twice
};
struct SurroundOutcome {
  double returned_mj = 0;    ///< greatest over any interval, in the plant
  double buzz_mm_per_s = 0;  ///< rms speed of the tip while the hand is at rest
  double moved_at_rest_mm = 0, given_at_rest_mj = 0;  ///< during that time (Plant)
  double most_force_n = 0;                            ///< greatest acting force while stock appears
  int changes = 0;  ///< number of changes of the session's stock or the tool
  std::uint64_t trips = 0;
};
SurroundOutcome surround(const Surround& surround);

}  // namespace kerf::agent
