// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <expected>
#include <map>
#include <string>
#include <string_view>

#include "server/formats/control/axes.h"
#include "server/formats/program_error.h"

namespace kerf {

struct Scene;

/// One tool of a controller's tool table.
struct ToolTableEntry {
  int number = 0;                                  ///< T, at least 1
  int pocket = 0;                                  ///< P
  GcodeAxes offset{};                              ///< tool offset: spindle nose to tip
  double diameter_mm = 0;                          ///< D, for cutter compensation
  double front_angle_deg = 0, back_angle_deg = 0;  ///< I, J of a lathe tool
  int orientation = 0;  ///< Q of a lathe tool, 1 to 9; 0 and 9 are symmetric about the spindle
};

/// A controller's tool table. The key is the tool number.
using ToolTable = std::map<int, ToolTableEntry>;

/// Most tools of a table (LinuxCNC's limit).
inline constexpr std::size_t kToolTableMax = 1000;

/// Reads a LinuxCNC tool table: one tool per line as words T P X Y Z A B C D I J Q in any order,
/// for example "T1 P1 D6 Z+50.2 ; 6 mm end mill"; ';' starts a comment. Lengths are in the
/// machine's unit and returned in mm. `name` is the file name for errors. Errors, with line and
/// word: an unknown word, an invalid number, an offset of U, V or W, a missing or duplicate T, more
/// than kToolTableMax tools.
std::expected<ToolTable, ProgramError> read_tool_table(const std::string& name,
                                                       std::string_view text,
                                                       double machine_unit_mm = 1);

/// Makes a tool table of the scene's tools: offsets of zero, pocket numbers equal to tool numbers,
/// and the greatest diameter of the cutting part.
ToolTable tool_table_of(const Scene& scene);

}  // namespace kerf
