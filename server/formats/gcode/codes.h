// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "server/formats/gcode/dialect.h"

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
  kTcp,
  kJump,         ///< M97, M98, M99 of Macro B
  kPolar,        ///< G15, G16
  kScaling,      ///< G50, G51
  kMirror,       ///< G50.1, G51.1, G100, G101
  kRotation,     ///< G68, G69
  kMoreSystems,  ///< G54.1, G154, G110 to G129: further coordinate systems
  kNoEffect,     ///< codes without effect on the path; a block may have several
  kUnknown       ///< M codes of the machine, which do not move it; a block may have several
};

/// Returns the modal group of a G code (`letter` 'g', code times ten: G43.4 is 434) or an M code
/// ('m'). Throws ProgramFault for an unsupported code. `text` is the word as written, for the
/// error.
GcodeGroup gcode_group(char letter, int code, const std::string& text,
                       const DialectRules& rules = rules_of(Dialect{}));

/// Whether a non-modal code uses the axis words of its block, which then has no motion: G10, G28,
/// G30, G52, G92.
bool takes_axis_words(int code);
/// Whether a code (times ten) is a canned cycle: G73, G74, G81 to G89.
bool is_canned_cycle(int code);

}  // namespace kerf
