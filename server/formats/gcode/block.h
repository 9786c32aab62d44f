// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "server/formats/gcode/codes.h"
#include "server/formats/gcode/parameters.h"

namespace kerf {

inline constexpr std::string_view kAxisLetters = "xyzabc";
/// Distance and angle of polar coordinates.
inline constexpr std::string_view kPolarLetters = "@^";

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

/// One line of G-code, read and checked against itself: every letter once, one code of each modal
/// group.
struct GcodeBlock {
  std::vector<GcodeWord> words;  ///< other than G, M, N
  std::vector<std::pair<GcodeGroup, GcodeCode>> codes;

  const GcodeCode* code(GcodeGroup group) const;
  bool has_code(GcodeGroup group, int code) const;
  const GcodeWord* find(char letter) const;
  /// The word's value; it then counts as used.
  std::optional<double> take(char letter);
  bool has_any(std::string_view letters) const;
};

/// A line without what is not code.
struct GcodeLine {
  std::string code;     ///< without comments, blanks and line end, in lower case
  std::string comment;  ///< the last one in parentheses, as written
};
/// Throws GcodeFault for a comment that does not end, stands within another, or runs Python.
GcodeLine split_gcode_line(std::string_view line);

/// Reads one line that split_gcode_line has left. Values use the parameters as they were before the
/// line; its assignments take effect after it. Throws GcodeFault.
GcodeBlock parse_gcode_block(std::string_view code, GcodeParameters& parameters,
                             bool position_readable = true);

}  // namespace kerf
