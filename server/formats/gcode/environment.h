// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <vector>

#include "server/formats/gcode/tool_table.h"

namespace kerf {

/// Most lines that a program may pass, subroutines and loops included, before it counts as endless.
inline constexpr std::size_t kGcodeLinesMax = 10'000'000;

/// What a program in G-code finds at its controller, beside its own text.
struct GcodeEnvironment {
  /// Of the tool table and of the parameters; programs begin in it.
  double machine_unit_mm = 1;
  /// Where "name.ngc" of a subroutine is looked for, in this order. Without any, no file is read.
  std::vector<std::filesystem::path> subroutine_folders;
  /// In mm. Without it, tools are those of the scene, and offsets of their lengths are 0.
  std::optional<ToolTable> tools;
  /// #-parameters from the start on (parameter_file.h), lengths in the machine's unit. With them,
  /// the machine's zero is known: the workpiece's zero, which is the scene's, lies at the zero of
  /// G54.
  std::optional<std::map<int, double>> parameters;
  std::size_t lines_max = kGcodeLinesMax;
};

}  // namespace kerf
