// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "server/formats/gcode/dialect.h"
#include "server/formats/gcode/tool_table.h"

namespace kerf {

/// The machine that a G-code program runs on, for run_gcode.
struct GcodeSetup {
  std::string machine_name;          ///< name in errors
  std::string_view axes = "xyzabc";  ///< the machine's axes, a subset of these letters
  double machine_unit_mm = 1;        ///< unit of the parameters of offsets, homes and tools, mm
  double unit_mm = 1;                ///< unit of the program until G20 or G21, mm
  bool tool_axis_words = false;      ///< I J K on G0 and G1 give the tool axis
  ToolTable tools;                   ///< in mm
  bool tools_of_scene = false;       ///< no tool table was given: length offsets are 0
  DialectRules rules;                ///< of the controller
  bool changes_by_t = false;         ///< T changes the tool: the program has no M6
  bool absolute_centers = false;     ///< I J K of arcs are coordinates
  bool offsets_are_wear = false;     ///< the program describes the tool's center: D counts 0
  bool machine_zero_known = false;   ///< machine coordinates have a position in the workpiece
};

}  // namespace kerf
