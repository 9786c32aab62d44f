#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "server/formats/gcode/parameters.h"

namespace kerf {

inline constexpr std::string_view kAxisLetters = "xyzabc";

/// A letter with its value, e.g. X[#<scale>*2].
struct GcodeWord {
  char letter = 0;  ///< lower case
  double value = 0;
  std::string text;  ///< as written, in upper case and without blanks
  bool used = false;
};

/// G codes are kept times ten: G43.4 is 434.
struct GcodeCode {
  int code = 0;
  std::string text;
};

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
  kStop,
  kToolChange,
  kSpindle,
  kCoolant,
  kOverride,
  kTcp
};

/// One line of G-code, read and checked against itself: every letter once, one code of each modal
/// group.
struct GcodeBlock {
  std::vector<GcodeWord> words;  ///< other than G, M, N
  std::vector<std::pair<GcodeGroup, GcodeCode>> codes;
  bool deleted = false;  ///< began with '/': block delete is on

  const GcodeCode* code(GcodeGroup group) const;
  const GcodeWord* find(char letter) const;
  /// The word's value; it then counts as used.
  std::optional<double> take(char letter);
  bool has_any(std::string_view letters) const;
};

/// G10, G28, G30 and G92 take the axis words of their block; no motion is left for them.
bool takes_axis_words(int code);

/// Reads one line. Values use the parameters as they were before the line; its assignments take
/// effect after it. Throws GcodeFault.
GcodeBlock parse_gcode_block(std::string_view line, GcodeParameters& parameters);

/// The line without comments, blanks and carriage return, in lower case. Throws GcodeFault for a
/// comment that does not end.
std::string strip_gcode_line(std::string_view line);

}  // namespace kerf
