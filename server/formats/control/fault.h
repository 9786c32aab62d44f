// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace kerf {

/// Thrown by the readers of programs for an invalid line. A reader adds file and line and returns a
/// ProgramError.
struct ProgramFault {
  std::string word;    ///< the invalid word as written; if empty, the error shows the whole line
  std::string reason;  ///< one clause
};

}  // namespace kerf
