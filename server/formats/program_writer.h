// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <expected>
#include <iosfwd>
#include <memory>
#include <string>

#include "server/formats/program.h"

namespace kerf {

/// Success, or why a program cannot be written: a pose that the machine cannot reach, or an output
/// stream that failed. The error is one sentence.
using WriteResult = std::expected<void, std::string>;

/// Writes a program motion by motion, so that a journal of any length can be exported without
/// holding it in memory:
///     auto writer = make_program_writer(ProgramFormat::kGcode, scene, out, 0);
///     for (const ProgramMotion& motion : motions)
///       if (auto written = writer->add(motion); !written) return written;
///     return writer->finish();
/// If a motion does not start where the previous one ended, the tool is retracted and placed at the
/// start without cutting.
class ProgramWriter {
 public:
  virtual ~ProgramWriter() = default;
  /// Adds a comment line to the head of the program. Call before the first add().
  virtual void note(const std::string& line) = 0;
  /// Writes one motion. Poses are rounded to the pose grid.
  virtual WriteResult add(const ProgramMotion& motion) = 0;
  /// Writes the end of the program and flushes the stream. Call once, after the last motion.
  virtual WriteResult finish() = 0;
};

/// Makes a writer of RS-274 G-code for the scene's machine. For `xyz` and `tool-vector`, reading
/// the text back gives bit-identical poses. For `xyzac-trt` and `xyzbc-trt` the tip is exact and
/// the axis is within 2e-8 (angles with six decimals). Durations are exact to 1e-6 relative.
/// For `xyz` a tilted tool is an error. `scene` and `out` must outlive the writer.
std::unique_ptr<ProgramWriter> make_gcode_writer(const Scene& scene, std::ostream& out);
/// Makes a writer of APT CL data: poses are bit-identical when read back, durations exact to 1e-6
/// relative. `scene` and `out` must outlive the writer.
std::unique_ptr<ProgramWriter> make_apt_writer(const Scene& scene, std::ostream& out);

/// Makes either of the writers above. With `tolerance_mm` > 0, consecutive motions are joined
/// within that tolerance (program_decimator.h) and the head of the program states it.
std::unique_ptr<ProgramWriter> make_program_writer(ProgramFormat format, const Scene& scene,
                                                   std::ostream& out, double tolerance_mm);

/// Shortest duration that is written, s. Shorter ones are raised to it, because a motion of zero
/// duration has no finite feed.
inline constexpr double kWrittenDurationMinS = 1e-9;

/// Writes all motions of a program and finishes it.
WriteResult write_program(const Program& program, ProgramWriter& writer);

}  // namespace kerf
