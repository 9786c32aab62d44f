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
    kProgram,  ///< a bare O number: where M98 enters
    kM98,
    kM99
  };
  Keyword keyword = Keyword::kSub;
  std::string name;
  std::string text;            ///< the word as written, in upper case
  std::vector<double> values;  ///< a condition, arguments, or a returned value
  int repeats = 1;             ///< L of M98
};

/// The parameters that an O word's values are taken from.
struct OWordContext {
  const GcodeParameters& parameters;
  bool position_readable = true;
};

/// Whether the line is control flow; `within_subroutine` decides what M99 is.
bool is_o_word(const GcodeLine& line, bool within_subroutine);
/// Reads it. Without `with_values` only name and keyword, as for a line that is passed over. Throws
/// GcodeFault.
OWord read_o_word(const GcodeLine& line, const OWordContext& context, bool with_values);

}  // namespace kerf
