// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "server/formats/gcode/block.h"

namespace kerf {

/// A line of control flow: "O<name> while [#1 lt 5]", "O100 call [1] [2]", "M98 P100 L3", "M99".
struct OWord {
  enum class Keyword {
    kSub,
    kEndsub,
    kCall,
    kReturn,
    kDo,
    kWhile,
    kEndwhile,
    kRepeat,
    kEndrepeat,
    kIf,
    kElseif,
    kElse,
    kEndif,
    kBreak,
    kContinue,
    kProgram,  ///< an O number alone: the start of a program called by M98
    kM98,
    kM99
  };
  Keyword keyword = Keyword::kSub;
  std::string name;
  std::string text;            ///< label and keyword as written, in upper case
  std::vector<double> values;  ///< the condition, the arguments or the return value
  int repeats = 1;             ///< L of M98
};

/// The state in which the values of an O word are evaluated.
struct OWordContext {
  const GcodeParameters& parameters;
  bool position_readable = true;
};

/// Returns whether a line is control flow. M99 is, if `within_subroutine`.
bool is_o_word(const GcodeLine& line, bool within_subroutine);
/// Reads a line of control flow. Without `with_values` it reads only name and keyword, for lines
/// that are skipped. Throws ProgramFault.
OWord read_o_word(const GcodeLine& line, const OWordContext& context, bool with_values);

}  // namespace kerf
