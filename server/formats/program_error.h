// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>

namespace kerf {

/// The reason and the position at which a program, a tool table or a parameter file was rejected.
struct ProgramError {
  std::string file;
  std::size_t line = 0;       ///< from 1; 0 if the error concerns the whole file
  std::string word;           ///< the invalid word as written, the whole line, or empty
  std::string reason;         ///< one clause, e.g. "must be an integer from 0 to 9"
  std::string language = {};  ///< as which the file was read, e.g. "LinuxCNC"; may be empty
};
/// Formats an error as one line, e.g. "part.ngc:12: 'P12' must be an integer from 0 to 9 (read as
/// LinuxCNC)". Control characters in the word are replaced and long words cut off.
std::string to_string(const ProgramError& error);

}  // namespace kerf
