// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <string_view>

#include "kernel/sculpture_command.h"
#include "kernel/tool/tool_shape.h"
#include "server/formats/tool_words.h"

namespace kerf {

/// A tool described by a comment of a program.
struct StatedTool {
  ToolShape shape;
  std::size_t line = 0;                 ///< of the comment, from 1
  std::string_view source = "comment";  ///< "CUTTER" of APT, "TOOL DEF" of Klartext
  ToolOrigins origins = {};
  std::string doubt = {};  ///< as of WordedTool
};

/// Returns the tools that the comments of a program describe (tool_words.h), by number: a comment
/// with a number, such as "(T1 D=6. CR=0. - flat end mill)" or "(TOOL 2 - 1/4 BALL)"; otherwise one
/// that names a tool before the T word (TOOL CALL) that selects it, or after it and before the next
/// feed. Comments of Kerf's own exports (tool_comments) give the same tools again. In APT the tools
/// of CUTTER and TLDATA (apt/tools.h); in Klartext also those of TOOL DEF, as flat end mills,
/// without a comment. The first certain description of a number counts, else the first doubtful
/// one. Lengths without a unit are in the program's unit, `unit_mm`.
std::map<ToolId, StatedTool> stated_tools(std::string_view program, double unit_mm);

/// Returns the unit of a program in mm: 25.4 if G20 (G70) or UNITS/INCHES come before G21, or if
/// the first block of Klartext ends with INCH, else 1.
double program_unit_mm(std::string_view program);

}  // namespace kerf
