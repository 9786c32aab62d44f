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
#include "server/formats/machine_remark.h"
#include "server/formats/program_error.h"
#include "server/formats/scene.h"

namespace kerf {

/// One motion of a program: the tip moves on a straight line and the axis on a great circle, both
/// uniformly in time. If `from` differs from the previous motion's `to`, the tool has left the
/// workpiece in between (program start, tool change, retract in machine coordinates) and is placed
/// at `from` without cutting.
struct ProgramMotion {
  ToolId tool = 0;
  ToolPose from = {}, to = {};  ///< on the pose grid (pose_grid.h)
  double duration_s = 0;        ///< > 0
  std::uint32_t line = 0;       ///< line of the program text, from 1; 0 if unknown
  bool rapid = false;           ///< a traverse: G0, RAPID
  std::uint32_t file = 0;       ///< file of `line`: index into Program::files
  friend bool operator==(const ProgramMotion&, const ProgramMotion&) = default;
};

/// Returns the pose on a motion after a share of its duration, 0 to 1, not rounded to the grid.
ToolPose pose_on(const ProgramMotion& motion, double share);

/// Most motions of a program. A few lines of hostile text can request any number.
inline constexpr std::size_t kProgramMotionsMax = 10'000'000;
/// Most tool changes that Program::tool_changes records. Later ones are omitted.
inline constexpr std::size_t kProgramToolChangesMax = 1'000'000;
/// Most warnings that Program::warnings records. Later ones are omitted.
inline constexpr std::size_t kProgramWarningsMax = 100;

/// A tool change at a line of the program (see ProgramMotion for line and file).
struct ToolChange {
  ToolId tool = 0;  ///< 0: the spindle is left empty
  std::uint32_t line = 0, file = 0;
  friend bool operator==(const ToolChange&, const ToolChange&) = default;
};

/// A program as straight motions of the tools of a scene.
struct Program {
  std::string name;          ///< file name
  std::string read_as = {};  ///< language, and why it: "Haas: line 3 has G154"
  /// The number in the program's text (O1234), digits only, or "" without one.
  std::string number = {};
  std::vector<ProgramMotion> motions;
  std::vector<std::string> warnings;  ///< "file:line: text"
  std::size_t lines = 0;              ///< lines read of the program's own text
  /// Read in inches, because comments state sizes in inches and no word states the unit.
  bool assumed_inches = false;
  std::vector<std::string> files;  ///< the program itself, then the subroutine files it called
  std::vector<ToolChange> tool_changes;
  /// In order. Comments before the first tool change or motion are dropped. Empty for a sampled
  /// program.
  std::vector<ProgramRemark> remarks;
};

/// Languages of programs.
enum class ProgramFormat { kGcode, kApt };
/// Returns the format by file extension, ignoring case: .apt and .cls are APT, extensions of
/// controllers and post-processors (.nc, .ngc, .tap, .txt and more) are G-code. Any other extension
/// is an error.
std::expected<ProgramFormat, ProgramError> program_format(std::string_view file_name);

/// Reads a program, G-code or APT by the extension of `name`, for the tools, the machine and the
/// tolerance of a scene:
///     auto program = parse_program("part.ngc", text, scene);
///     if (!program) std::cerr << to_string(program.error()) << '\n';
/// Arcs, splines and long rotary moves become chords within the scene's tolerance_mm. Every pose is
/// on the pose grid, and no motion turns the axis by more than kTurnMaxRad. Words and statements
/// that are not supported are errors, never skipped. `environment` gives a G-code program its tool
/// table, parameters and subroutine folders; without it no file is read.
std::expected<Program, ProgramError> parse_program(const std::string& name, std::string_view text,
                                                   const Scene& scene,
                                                   const GcodeEnvironment& environment = {});

/// Formats the position of a motion or tool change as "file:line".
std::string place_of(const Program& program, std::uint32_t file, std::uint32_t line);

/// Divides a program into motions of 1/rate_hz seconds each along the programmed feed, as an agent
/// would stream it. The last motion before a jump or a tool change may be shorter. Poses are on the
/// pose grid. A motion that spans a corner cuts it off. A warning reports the largest such error
/// above 0.01 mm. `rate_hz` > 0. Check sample_count first, because the result has no limit of its
/// own.
Program sample_program(const Program& program, double rate_hz);

/// Returns the approximate number of motions that sample_program makes.
double sample_count(const Program& program, double rate_hz);
/// Limit for sample_count: two days at 100 Hz.
inline constexpr double kSamplesMax = 2e7;

}  // namespace kerf
