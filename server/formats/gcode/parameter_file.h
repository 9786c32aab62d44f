// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <expected>
#include <map>
#include <string>
#include <string_view>

#include "server/formats/program_error.h"

namespace kerf {

/// Reads LinuxCNC's parameter file: a number and a value on each line, in ascending order. Lines
/// without two numbers are skipped, as LinuxCNC does. Offsets and homes are in the machine's
/// unit and in degrees.
std::expected<std::map<int, double>, ProgramError> read_parameter_file(const std::string& name,
                                                                       std::string_view text);

}  // namespace kerf
