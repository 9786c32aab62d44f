// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <set>
#include <string>

#include "server/formats/control/fault.h"
#include "server/formats/motion_sink.h"
#include "server/formats/program_reader.h"

namespace kerf {

/// Most lines that a program may execute beyond its size in bytes, in loops and calls.
inline constexpr std::size_t kRepeatedLinesMax = 1'000'000;

/// Reads a program line by line: makes the pending motions of a line before the next line is
/// executed, and adds the place to its faults.
class LineReader : public ProgramReader {
 public:
  std::expected<bool, ProgramError> step() final;

 protected:
  LineReader() : sink_(program_) {}
  /// Executes a line. Returns false at the end of the program. Throws ProgramFault.
  virtual bool execute() = 0;
  /// Called after the last motion. Throws ProgramFault.
  virtual void finish() {}
  /// The error of a fault of the current line.
  virtual ProgramError error_of(const ProgramFault& fault) const = 0;
  /// The error of a pending motion of a line.
  virtual ProgramError error_at(MotionSink::Place, const std::string& reason) const {
    return error_of({"", reason});
  }
  /// Adds a warning unless there are kProgramWarningsMax.
  void warn(const std::string& warning);
  /// The same with the place, but only once for each text.
  void warn_once(const std::string& text, std::size_t line);

  MotionSink sink_;

 private:
  std::optional<ProgramError> run();
  std::optional<ProgramError> follow_path();

  std::set<std::string> warned_;
  bool runs_ = true;
};

/// Reads a program with `read`, whose argument is a warning. If the tool's radius is not possible,
/// reads it again with the warning that `wear` is assumed: offsets of 0, because the path is that
/// of the tool's center. Returns the attempt that went further.
std::expected<ReadProgram, ProgramError> read_or_assume_wear(
    const std::function<std::expected<ReadProgram, ProgramError>(const std::string&)>& read,
    const std::string& name, const std::string& wear);

}  // namespace kerf
