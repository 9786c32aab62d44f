// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace kerf {

/// Modal groups of LinuxCNC: a block may contain one code of each.
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

/// Returns the modal group of a G code (`letter` 'g', code times ten: G43.4 is 434) or an M code
/// ('m'). Throws GcodeFault for an unsupported code; `text` is the word as written, for the error.
GcodeGroup gcode_group(char letter, int code, const std::string& text);

/// Whether a non-modal code uses the axis words of its block, which then has no motion: G10, G28,
/// G30, G52, G92.
bool takes_axis_words(int code);
/// Whether a code (times ten) is a canned cycle: G73, G74, G81 to G89.
bool is_canned_cycle(int code);

}  // namespace kerf
