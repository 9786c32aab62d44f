// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>

#include "server/formats/gcode/arc.h"
#include "server/formats/gcode/modes.h"

namespace kerf {

/// Sticky words of canned cycles, kept from block to block, mm and s.
struct CycleMemory {
  int code = 0;  ///< the last cycle, times ten; 0 after another motion
  double r = 0, depth = 0, p = 0, q = 0, i = 0, j = 0, k = 0;
  /// The words that LinuxCNC requires may be missing, and the spindle is not watched (Macro B).
  bool lenient = false;
  std::optional<double> initial_level;  ///< level at which the first of consecutive cycles started
};

/// The words of a canned cycle in one block, mm and s, in the axes of its plane.
struct CycleWords {
  std::optional<double> first, second;        ///< position of the hole
  std::optional<double> depth;                ///< bottom of the hole
  std::optional<double> distance, angle_deg;  ///< position in polar coordinates (@ ^)
  std::optional<double> r, p, q, i, j, k;
  int repeats = 1;  ///< 0 (Macro B): only stores the words
};

/// One step of a canned cycle, in the axes of its plane.
struct CycleStep {
  enum class Kind { kRapid, kFeed, kDwell };
  Kind kind = Kind::kRapid;
  PlanePoint to = {};
  double seconds = 0;  ///< kDwell
};

/// Expands the canned cycles G73, G74 and G81 to G89 as LinuxCNC does; `code` is times ten. Starts
/// at `at` and returns the final position. Words missing in the block are taken from `memory`,
/// which is updated. Throws GcodeFault for a missing word, an R plane below the bottom of the hole,
/// or a spindle that is stopped or turns in the wrong direction.
PlanePoint expand_cycle(int code, const GcodeModes& modes, PlanePoint at, const CycleWords& words,
                        CycleMemory& memory, const std::function<void(const CycleStep&)>& step);

}  // namespace kerf
