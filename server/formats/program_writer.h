// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <expected>
#include <iosfwd>
#include <memory>
#include <string>

#include "server/formats/program.h"

namespace kerf {

/// Why a program cannot be written: a pose that the machine cannot reach, or a stream that failed.
/// One sentence.
using WriteResult = std::expected<void, std::string>;

/// Writes motions one after the other, so that a journal of any length can be exported without
/// holding it in memory. Where a motion does not start where the last one ended, the tool is
/// retracted and placed anew without cutting.
class ProgramWriter {
 public:
  virtual ~ProgramWriter() = default;
  /// A line for the program's head; before the first motion.
  virtual void note(const std::string& line) = 0;
  virtual WriteResult add(const ProgramMotion& motion) = 0;
  /// The end of the program; call once, after the last motion.
  virtual WriteResult finish() = 0;
};

/// RS-274 for the scene's machine. `xyz` and `tool-vector` hold every pose exactly: reading the
/// text back gives the same poses bit by bit. `xyzac-trt` and `xyzbc-trt` hold the tip exactly and
/// the axis to 1e-8 (angles with six decimals). Feeds hold durations to 1e-6 relative. `scene` and
/// `out` must outlive the writer.
std::unique_ptr<ProgramWriter> make_gcode_writer(const Scene& scene, std::ostream& out);
/// APT CL data: every pose exactly, durations to 1e-6 relative.
std::unique_ptr<ProgramWriter> make_apt_writer(const Scene& scene, std::ostream& out);

/// Either of them; with a tolerance above 0, motions are joined within it (program_decimator.h),
/// and the program's head says so.
std::unique_ptr<ProgramWriter> make_program_writer(ProgramFormat format, const Scene& scene,
                                                   std::ostream& out, double tolerance_mm);

/// No motion is written shorter than this, s: a motion without duration has no feed, and none is
/// needed for what it cuts.
inline constexpr double kWrittenDurationMinS = 1e-9;

/// All motions of a program through one of the writers above.
WriteResult write_program(const Program& program, ProgramWriter& writer);

}  // namespace kerf
