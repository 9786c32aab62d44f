// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <expected>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "server/formats/gcode/environment.h"

namespace kerf {

/// Files with the state of the controller at the start of a G-code program.
struct EnvironmentFiles {
  std::optional<std::filesystem::path> tool_table, parameters;
  std::vector<std::filesystem::path> subroutine_folders;  ///< searched after the program's own
  Dialect dialect = Dialect::kAuto;                       ///< of the program
  bool inch_machine = false;  ///< tool table and parameters are in inches; programs begin in G20
};

/// Reads the files. Subroutines are searched for next to the program first. The error is
/// "file:line: reason".
std::expected<GcodeEnvironment, std::string> load_environment(const EnvironmentFiles& files,
                                                              const std::filesystem::path& program);

}  // namespace kerf
