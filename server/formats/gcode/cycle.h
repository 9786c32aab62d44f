// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>

#include "server/formats/gcode/arc.h"
#include "server/formats/gcode/modes.h"

namespace kerf {

/// What canned cycles keep from block to block, mm and s.
struct CycleMemory {
  int code = 0;  ///< the last cycle; 0 after another motion
  double r = 0, depth = 0, p = 0, q = 0, i = 0, j = 0, k = 0;
  std::optional<double> initial_level;  ///< where the first cycle of a run began
};

/// The words of a block that a cycle looks at, in mm, in the axes of its plane.
struct CycleWords {
  std::optional<double> first, second;        ///< where the hole is
  std::optional<double> depth;                ///< its bottom
  std::optional<double> distance, angle_deg;  ///< the hole in polar coordinates (@ ^)
  std::optional<double> r, p, q, i, j, k;
  int repeats = 1;
};

/// A step of a cycle, in the plane's axes.
struct CycleStep {
  enum class Kind { kRapid, kFeed, kDwell };
  Kind kind = Kind::kRapid;
  PlanePoint to = {};
  double seconds = 0;  ///< kDwell
};

/// Expands G73, G74, G81 to G89 as LinuxCNC does; `code` is times ten. `at` is where the tool is.
/// What the block leaves out is remembered from the cycle before. Returns where the tool is then.
/// Throws GcodeFault for what is missing, below the surface that it starts from, or needs a turning
/// spindle.
PlanePoint expand_cycle(int code, const GcodeModes& modes, PlanePoint at, const CycleWords& words,
                        CycleMemory& memory, const std::function<void(const CycleStep&)>& step);

}  // namespace kerf
