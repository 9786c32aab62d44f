// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <expected>
#include <map>
#include <string>
#include <string_view>

#include "server/formats/program_error.h"

namespace kerf {

/// Reads a LinuxCNC parameter file (.var): a parameter number and its value on each line, numbers
/// ascending. Lines without two numbers are skipped, as in LinuxCNC. Offsets and home positions are
/// in the machine's length unit and in degrees. `name` is the file name for errors. Errors: a
/// number outside of 1 to 5601 or not ascending, a value that is not finite.
std::expected<std::map<int, double>, ProgramError> read_parameter_file(const std::string& name,
                                                                       std::string_view text);

}  // namespace kerf
