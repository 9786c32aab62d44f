// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace kerf {

/// Thrown by the G-code interpreter and by implementations of GcodeCanon for an invalid line.
/// run_gcode turns it into a ProgramError with file and line.
struct GcodeFault {
  std::string word;    ///< the invalid word as written; if empty, the error shows the whole line
  std::string reason;  ///< one clause
};

}  // namespace kerf
