// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <expected>
#include <string>
#include <string_view>

#include "server/formats/gcode/dialect.h"
#include "server/formats/program_error.h"

namespace kerf {

/// The dialect as which a program is read, and why.
struct DialectChoice {
  Dialect dialect = Dialect::kLinuxcnc;
  std::string reason;  ///< one clause: "line 12 has G154, which only Haas has"
  /// No word of the program points to one controller: it may be read as another one.
  bool open = false;
};

/// Judges by the words of the first 20000 lines which controller a program is for. `name` is the
/// file name; .ngc is LinuxCNC's. Error: the program is in a language that is not read.
std::expected<DialectChoice, ProgramError> choose_dialect(const std::string& name,
                                                          std::string_view text);

}  // namespace kerf
