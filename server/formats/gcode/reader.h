// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include "server/formats/control/canon.h"
#include "server/formats/gcode/environment.h"
#include "server/formats/gcode/setup.h"
#include "server/formats/program_reader.h"

namespace kerf {

/// Reads a G-code program in the dialect of `environment` as motions of a scene's tools.
/// read_program calls it for files of G-code. `name` is the file name for errors. README.md in this
/// folder lists the supported codes. Any other code is an error.
std::expected<ReadProgram, ProgramError> read_gcode(const std::string& name, std::string_view text,
                                                    const Scene& scene,
                                                    const GcodeEnvironment& environment,
                                                    ProgramVisitor& visitor);

/// Result of run_gcode.
struct GcodeRun {
  std::size_t lines = 0;           ///< last line read
  std::vector<std::string> files;  ///< the program itself, then the subroutine files it called
};

/// Interprets a G-code program and sends its canonical calls to `canon`:
///     struct Printer final : kerf::GcodeCanon { … };
///     auto run = run_gcode("part.ngc", text, {}, {.machine_name = "mill"}, printer, warn);
/// `warn` receives each warning as "file:line: text". After an error, the calls before the invalid
/// line have been made.
std::expected<GcodeRun, ProgramError> run_gcode(
    const std::string& name, std::string_view text, const GcodeEnvironment& environment,
    GcodeSetup setup, GcodeCanon& canon, const std::function<void(const std::string&)>& warn);

}  // namespace kerf
