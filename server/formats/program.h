// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <expected>
#include <string>
#include <string_view>
#include <vector>

#include "kernel/sculpture.h"
#include "server/formats/gcode/environment.h"
#include "server/formats/program_error.h"
#include "server/formats/scene.h"

namespace kerf {

/// One motion of a program: the tip on a straight line, the axis on the great circle, both
/// uniformly. Where `from` is not the `to` of the motion before, the tool was away in between
/// (program start, tool change, retract in machine coordinates): it jumps there without cutting.
struct ProgramMotion {
  ToolId tool = 0;
  ToolPose from, to;       ///< on the pose grid (pose_grid.h)
  double duration_s = 0;   ///< > 0
  std::uint32_t line = 0;  ///< of the program text, from 1; 0 where there is none
  bool rapid = false;      ///< G0, RAPID
  std::uint32_t file = 0;  ///< where `line` stands: in Program::files
  friend bool operator==(const ProgramMotion&, const ProgramMotion&) = default;
};

/// Most motions that a program may become, 112 bytes each: a few lines of hostile text can ask for
/// any number.
inline constexpr std::size_t kProgramMotionsMax = 10'000'000;
/// A program notes at most this many tool changes.
inline constexpr std::size_t kProgramToolChangesMax = 1'000'000;
/// A program collects at most this many warnings.
inline constexpr std::size_t kProgramWarningsMax = 100;

/// A tool that is taken into the spindle.
struct ToolChange {
  ToolId tool = 0;  ///< 0: the spindle is left empty
  std::uint32_t line = 0, file = 0;
  friend bool operator==(const ToolChange&, const ToolChange&) = default;
};

struct Program {
  std::string name;
  std::vector<ProgramMotion> motions;
  std::vector<std::string> warnings;  ///< "file:line: text"; what was read but has no meaning here
  std::size_t lines = 0;              ///< of the text
  std::vector<std::string> files;     ///< the program itself, then the subroutines' files it called
  std::vector<ToolChange> tool_changes;
};

enum class ProgramFormat { kGcode, kApt };
/// By extension: .apt and .cls are APT; .ngc, .nc, .tap, .gcode are G-code; anything else is an
/// error.
std::expected<ProgramFormat, ProgramError> program_format(std::string_view file_name);

/// Reads a program (G-code or APT by the extension of `name`) for a scene: its tools, its machine
/// kinematics, its tolerance (arcs and long rotary moves become chords within it). Every pose is on
/// the pose grid and no motion turns the axis by more than kTurnMaxRad. Anything that is not
/// understood is an error, never skipped.
/// A program in G-code may lean on its controller's tool table, parameters and subroutines:
/// `environment` tells them. Without it no file is read but the text.
std::expected<Program, ProgramError> parse_program(const std::string& name, std::string_view text,
                                                   const Scene& scene,
                                                   const GcodeEnvironment& environment = {});

/// Where a motion stands: "file:line".
std::string place_of(const Program& program, std::uint32_t file, std::uint32_t line);

/// The same path cut into motions of 1/rate_hz seconds each along the programmed feed (the last one
/// of a chain of motions may be shorter). Poses are on the pose grid. A motion that spans a corner
/// cuts it; from 0.01 mm on a warning says by how much. `rate_hz` > 0. Check sample_count first: a
/// slow program at a high rate has no end.
Program sample_program(const Program& program, double rate_hz);

/// About how many motions sample_program would make.
double sample_count(const Program& program, double rate_hz);
/// Most that a caller should ask for: 100 bytes each.
inline constexpr double kSamplesMax = 2e7;

}  // namespace kerf
