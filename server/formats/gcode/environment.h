// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <vector>

#include "server/formats/gcode/dialect.h"
#include "server/formats/gcode/tool_table.h"

namespace kerf {

/// Default limit for the lines that a program executes, subroutines and loops included.
inline constexpr std::size_t kGcodeLinesMax = 10'000'000;

/// The state of the controller that runs a G-code program: unit, subroutines, tool table and
/// parameters.
///     GcodeEnvironment environment;
///     environment.tools = read_tool_table("tool.tbl", text).value();
///     auto program = parse_program("part.ngc", part, scene, environment);
struct GcodeEnvironment {
  /// The controller's dialect; kAuto: judged by the program.
  Dialect dialect = Dialect::kAuto;
  /// The machine's length unit, mm: 1 or 25.4. It is the unit of `parameters` and, until G20 or
  /// G21, of the program.
  double machine_unit_mm = 1;
  /// Folders searched, in order, for the file "name.ngc" of a subroutine. If empty, no file is
  /// read.
  std::vector<std::filesystem::path> subroutine_folders;
  /// Tool table, in mm. Without it the scene's tools are used and length offsets (G43 H) are 0.
  std::optional<ToolTable> tools;
  /// Initial values of numbered parameters (parameter_file.h), lengths in the machine's unit. With
  /// them the machine zero is known: the origin of G54 is the scene's origin.
  std::optional<std::map<int, double>> parameters;
  /// Most lines that the program may execute. More is an error.
  std::size_t lines_max = kGcodeLinesMax;
};

}  // namespace kerf
