// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <expected>
#include <iosfwd>
#include <memory>
#include <optional>
#include <string>

#include "server/formats/arc_fit.h"
#include "server/formats/drilled_hole.h"
#include "server/formats/machine_remark.h"
#include "server/formats/post.h"
#include "server/formats/program.h"

namespace kerf {

/// Success, or the reason why a program cannot be written: a pose that the machine cannot reach, or
/// a failed output stream. The error is one sentence.
using WriteResult = std::expected<void, std::string>;

/// Writes a program motion by motion, so that a journal of any length can be exported without
/// holding it in memory:
///     auto writer = make_program_writer({.post = Post::kFanuc}, scene, out);
///     if (!writer) return std::unexpected(writer.error());
///     for (const ProgramMotion& motion : motions)
///       if (auto written = (*writer)->add(motion); !written) return written;
///     return (*writer)->finish();
/// If a motion does not start where the previous one ended, the tool is retracted and placed at the
/// start without cutting.
class ProgramWriter {
 public:
  virtual ~ProgramWriter() = default;
  /// Adds a comment line to the head of the program. Call before the first add().
  virtual void note(const std::string& line) = 0;
  /// Sets the program's number, in digits, if the control has numbers. Call before the first add().
  virtual void set_number(const std::string&) {}
  /// Writes one motion. Poses are rounded to the pose grid.
  virtual WriteResult add(const ProgramMotion& motion) = 0;
  /// Whether the control supports such an arc.
  virtual bool takes(const FittedArc&) const { return false; }
  /// Writes a motion whose tip follows an arc. Precondition: takes(arc).
  virtual WriteResult add_arc(const ProgramMotion& motion, const FittedArc& arc);
  /// Whether the control has a cycle for such a hole.
  virtual bool drills(const DrilledHole&) const { return false; }
  /// Writes the cycle of a hole. `first` is the first of its motions. Precondition: drills(hole).
  virtual WriteResult add_hole(const ProgramMotion& first, const DrilledHole& hole);
  /// Writes the remark that comes before the next motion.
  virtual WriteResult remark(const MachineRemark& said) = 0;
  /// Writes the end of the program and flushes the stream. Call once, after the last motion.
  virtual WriteResult finish() = 0;
};

/// Returns the reason why programs for a control cannot be written for a machine, one sentence, or
/// nullopt.
std::optional<std::string> post_rejection(Post post, MachineKinematics kinematics);

/// Makes a writer for a control and the scene's machine. For LinuxCNC, reading the text back gives
/// bit-identical poses with `xyz` and `tool-vector`; with `xyzac-trt` and `xyzbc-trt` the tip is
/// exact and the axis is within 2e-8 (angles with six decimals), and durations are exact to 1e-6
/// relative. For other controls every number is rounded as in PostRules. Errors of the writer: with
/// `xyz` a tilted tool. Error: post_rejection. `scene` and `out` must outlive the writer.
std::expected<std::unique_ptr<ProgramWriter>, std::string> make_post_writer(Post post,
                                                                            const Scene& scene,
                                                                            std::ostream& out);
/// Like the above for LinuxCNC, which accepts every machine. Programs of `tool-vector` are for Kerf
/// only.
std::unique_ptr<ProgramWriter> make_gcode_writer(const Scene& scene, std::ostream& out);
/// Makes a writer of APT CL data: poses are bit-identical when read back, durations exact to 1e-6
/// relative. `scene` and `out` must outlive the writer.
std::unique_ptr<ProgramWriter> make_apt_writer(const Scene& scene, std::ostream& out);

/// Format and options of a written program.
struct ProgramStyle {
  ProgramFormat format = ProgramFormat::kGcode;
  Post post = Post::kLinuxcnc;  ///< of G-code
  double tolerance_mm = 0;  ///< if > 0, motions are joined within it to lines and, if the control
                            ///< supports them, arcs (program_decimator.h)
};

/// Makes one of the writers above. Error: that of make_post_writer.
std::expected<std::unique_ptr<ProgramWriter>, std::string> make_program_writer(
    const ProgramStyle& style, const Scene& scene, std::ostream& out);

/// Shortest duration that is written, s. Shorter ones are raised to it, because a motion of zero
/// duration has no finite feed.
inline constexpr double kWrittenDurationMinS = 1e-9;

/// Writes all motions and remarks of a program and finishes it.
WriteResult write_program(const Program& program, ProgramWriter& writer);

}  // namespace kerf
