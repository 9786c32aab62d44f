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

/// Facts about a program, for deriving its scene.
struct ProgramFacts {
  /// The first of xyz, xyzac-trt, xyzbc-trt and tool-vector with which the program can be read.
  MachineKinematics kinematics = MachineKinematics::kXyz;
  std::vector<ToolId> tools;        ///< tools that move, ascending
  std::vector<ToolId> named_tools;  ///< tools numbered in its text, ascending; 1 if there is none
  bool numbers_no_tool = false;
  std::optional<CutExtents> cuts;
  std::size_t motions = 0;
  double duration_s = 0;        ///< at feed rate
  double machine_s = 0;         ///< on a machine (MachineTime)
  bool assumed_inches = false;  ///< as of Program
  /// An unused number, if the program cuts before it loads one of several tools; else 0.
  ToolId spindle_tool = 0;
};

/// Reads a program without a scene. Its tools are those that its text numbers, assumed thin, so
/// that offsets for their radius are always possible. Errors: those of parse_program for the
/// machine with which it can be read farthest; an incomplete reading, soon after a stop is
/// requested.
std::expected<ProgramFacts, ProgramError> program_facts(const std::string& name,
                                                        std::string_view text,
                                                        const GcodeEnvironment& environment = {},
                                                        const std::stop_token& stop = {});

}  // namespace kerf
