// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace kerf {

/// Thrown inside the G-code reader where a line cannot be understood; read_gcode turns it into a
/// ProgramError with file and line. It never leaves this folder.
struct GcodeFault {
  std::string word;    ///< as written
  std::string reason;  ///< one sentence
};

}  // namespace kerf
