// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <expected>
#include <map>
#include <string>
#include <string_view>

#include "server/formats/gcode/axes.h"
#include "server/formats/program_error.h"

namespace kerf {

struct Scene;

/// A tool as a machine's controller knows it.
struct ToolTableEntry {
  int number = 0;
  int pocket = 0;
  GcodeAxes offset{};      ///< from the spindle's nose to the tip
  double diameter_mm = 0;  ///< of cutter compensation
  double front_angle_deg = 0, back_angle_deg = 0;
  int orientation = 0;  ///< of a lathe's tool, 1 to 9; 0 and 9 are round about the spindle
};

using ToolTable = std::map<int, ToolTableEntry>;

/// Most tools that a table may hold (LinuxCNC: 1000).
inline constexpr std::size_t kToolTableMax = 1000;

/// Reads LinuxCNC's tool table: one tool a line, T P X Y Z A B C D I J Q in any order, what follows
/// ';' is a comment. Lengths are in the machine's unit. Anything else is an error with its line and
/// word.
std::expected<ToolTable, ProgramError> read_tool_table(const std::string& name,
                                                       std::string_view text,
                                                       double machine_unit_mm = 1);

/// What the scene's tools are to a controller that was told nothing: tips without offsets, pockets
/// numbered as the tools, the greatest diameter of the cutting part.
ToolTable tool_table_of(const Scene& scene);

}  // namespace kerf
