// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "server/formats/gcode/codes.h"
#include "server/formats/gcode/dialect.h"
#include "server/formats/gcode/parameters.h"

namespace kerf {

/// Axis letters in the order of GcodeAxes.
inline constexpr std::string_view kAxisLetters = "xyzabc";
/// Letters of polar coordinates: distance and angle.
inline constexpr std::string_view kPolarLetters = "@^";

/// Letters of the words ",R" and ",C", a rounded or cut corner (Fanuc, Haas).
inline constexpr char kCornerRadius = 'R';
inline constexpr char kCornerChamfer = 'C';

/// A word: a letter with its value, e.g. X[#<scale>*2].
struct GcodeWord {
  char letter = 0;  ///< lower case, or kCornerRadius, kCornerChamfer
  double value = 0;
  std::string text;    ///< as written, in upper case and without blanks
  bool used = false;   ///< set when a function reads it; unused words are an error
  bool empty = false;  ///< G28 Z: an axis without a value, which take() does not return
};

/// A G or M code. G codes are stored times ten: G43.4 is 434.
struct GcodeCode {
  int code = 0;
  std::string text;  ///< the word as written, in upper case
};

/// One block (line) of G-code. Every letter occurs at most once, and at most one code of each modal
/// group.
struct GcodeBlock {
  std::vector<GcodeWord> words;  ///< all words except G, M and N
  std::vector<std::pair<GcodeGroup, GcodeCode>> codes;

  /// The code of a modal group, or nullptr if the block has none.
  const GcodeCode* code(GcodeGroup group) const;
  /// Removes the codes of a modal group.
  void drop(GcodeGroup group);
  bool has_code(GcodeGroup group, int code) const;
  /// The word of a letter, or nullptr if the block has none.
  const GcodeWord* find(char letter) const;
  /// Returns the value of a word and marks it as used.
  std::optional<double> take(char letter);
  /// Whether the block has a word of any of these letters.
  bool has_any(std::string_view letters) const;
};

/// A line of a program split into code and comment.
struct GcodeLine {
  std::string code;     ///< without comments, blanks and line end, in lower case
  std::string comment;  ///< the last comment in parentheses, as written
};
/// Splits a line. LinuxCNC: throws ProgramFault for an unclosed, unopened or nested comment and for
/// ";py,". Other dialects: comments may be nested, and an unclosed one ends with the line.
GcodeLine split_gcode_line(std::string_view line, const DialectRules& rules = rules_of(Dialect{}));

/// Returns whether a line is a percent sign alone, which begins or ends a program.
bool is_percent(std::string_view line);

/// Parses the code of one line. Expressions use the parameters from before the line. Assignments
/// take effect after it. `position_readable` as for GcodeValueReader. Throws ProgramFault.
GcodeBlock parse_gcode_block(std::string_view code, GcodeParameters& parameters,
                             bool position_readable = true,
                             const DialectRules& rules = rules_of(Dialect{}));

}  // namespace kerf
