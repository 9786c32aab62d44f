// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace kerf {

/// LinuxCNC's modal groups: a block may hold one code of each.
enum class GcodeGroup {
  kNonModal,
  kMotion,
  kPlane,
  kDistance,
  kArcDistance,
  kFeedMode,
  kUnits,
  kCutterCompensation,
  kToolLength,
  kRetract,
  kCoordinateSystem,
  kPathControl,
  kSpindleMode,
  kDiameter,
  kShiftApplied,
  kStop,
  kToolChange,
  kSpindle,
  kCoolant,
  kOverride,
  kInputOutput,
  kTcp
};

/// The group of a code: `letter` 'g' (the code times ten: G43.4 is 434) or 'm'. Throws GcodeFault
/// for one that Kerf does not read, with the reason where there is one better than that it is
/// unknown. `text` is the word as written.
GcodeGroup gcode_group(char letter, int code, const std::string& text);

/// G10, G28, G30, G52 and G92 take the axis words of their block; no motion is left for them.
bool takes_axis_words(int code);
/// G73, G74 and G81 to G89.
bool is_canned_cycle(int code);

}  // namespace kerf
