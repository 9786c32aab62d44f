// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "kernel/sculpture_command.h"
#include "kernel/tool/tool_shape.h"
#include "server/formats/apt/statement.h"

namespace kerf {

/// A cutter as stated by CUTTER or TLDATA.
struct AptCutter {
  double diameter_mm = 0;
  ToolShape shape;
};

/// Returns the cutter of CUTTER/d,r,e,f,alpha,beta,h, in which only d is required, or of
/// TLDATA/MILL,d,r,… and TLDATA/DRILL,… of NX, or nullopt for a kind of tool that these numbers do
/// not describe. Throws ProgramFault for a word that is not a number.
std::optional<AptCutter> apt_cutter(const AptStatement& statement, double unit_mm);

/// The tools of a program.
struct AptTools {
  bool loads = false;                   ///< LOADTL, LOAD/TOOL or TOOLNO numbers them
  std::map<std::string, ToolId> ranks;  ///< otherwise: of the names in TOOL PATH, from 1
  struct Tool {
    std::optional<ToolShape> shape;
    std::size_t line = 0;  ///< of CUTTER or TLDATA
  };
  std::map<ToolId, Tool> tools;  ///< those that are loaded
};

/// Returns the tools of a program. A cutter belongs to the next loaded tool, or, between a load and
/// the first motion, to the loaded one. Faults are left to read_apt.
AptTools apt_tools(std::string_view program);

/// Returns the unit of the program in mm: 25.4 if UNITS/INCHES comes first, else 1.
double apt_unit_mm(std::string_view program);

}  // namespace kerf
