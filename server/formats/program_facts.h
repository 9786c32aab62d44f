// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <expected>
#include <optional>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include "server/formats/cut_extents.h"
#include "server/formats/program.h"

namespace kerf {

/// What a program tells of the scene that it needs.
struct ProgramFacts {
  /// The first of xyz, xyzac-trt, xyzbc-trt and tool-vector as whose program it can be read.
  MachineKinematics kinematics = MachineKinematics::kXyz;
  std::vector<ToolId> tools;        ///< those that move, ascending
  std::vector<ToolId> named_tools;  ///< those that its text numbers, ascending, at least one
  std::optional<CutExtents> cuts;
  std::size_t motions = 0;
  double duration_s = 0;        ///< at feed rate
  double machine_s = 0;         ///< on a machine (MachineTime)
  bool assumed_inches = false;  ///< as of Program
  /// A number of no other tool, if the program cuts before it loads one of several; else 0.
  ToolId spindle_tool = 0;
};

/// Reads a program of which no scene is known. Its tools are those that its text numbers, taken as
/// thin, so that offsets for their radius are always possible. Errors: as of parse_program, for the
/// machine as whose program it can be read farthest; that it was not read to its end, soon after a
/// stop is requested.
std::expected<ProgramFacts, ProgramError> program_facts(const std::string& name,
                                                        std::string_view text,
                                                        const GcodeEnvironment& environment = {},
                                                        const std::stop_token& stop = {});

}  // namespace kerf
