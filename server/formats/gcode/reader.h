// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include "server/formats/gcode/canon.h"
#include "server/formats/gcode/environment.h"
#include "server/formats/gcode/machine.h"
#include "server/formats/program.h"

namespace kerf {

/// Reads RS-274 as LinuxCNC does, for a scene; README.md tells what is understood.
std::expected<Program, ProgramError> read_gcode(const std::string& name, std::string_view text,
                                                const Scene& scene,
                                                const GcodeEnvironment& environment = {});

/// What a run of a program was, beside what the canon was asked for.
struct GcodeRun {
  std::size_t lines = 0;           ///< of the program's own text
  std::vector<std::string> files;  ///< the program itself, then the files of subroutines
};

/// Runs a program against any canon. `warn` gets "file:line: text".
std::expected<GcodeRun, ProgramError> run_gcode(
    const std::string& name, std::string_view text, const GcodeEnvironment& environment,
    GcodeSetup setup, GcodeCanon& canon, const std::function<void(const std::string&)>& warn);

}  // namespace kerf
