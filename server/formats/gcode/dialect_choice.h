// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <expected>
#include <string>
#include <string_view>

#include "server/formats/gcode/dialect.h"
#include "server/formats/program_error.h"

namespace kerf {

/// The dialect of a program, and the reason.
struct DialectChoice {
  Dialect dialect = Dialect::kLinuxcnc;
  std::string reason;  ///< one clause: "line 12 has G154, which only Haas has"
  /// No word of the program identifies a controller, so another dialect may fit.
  bool open = false;
};

/// Judges from the first 20000 lines which controller a program is for. `name` is the file name;
/// .ngc is LinuxCNC's. Error: the program's language is not supported.
std::expected<DialectChoice, ProgramError> choose_dialect(const std::string& name,
                                                          std::string_view text);

}  // namespace kerf
