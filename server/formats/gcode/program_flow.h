// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string_view>

#include "server/formats/gcode/block.h"
#include "server/formats/gcode/parameters.h"
#include "server/formats/gcode/source.h"

namespace kerf {

/// Most consecutive lines without a motion (kGcodeLinesMax limits all lines).
inline constexpr std::size_t kGcodeIdleLinesMax = 1'000'000;
/// Lines of control flow per step, so that the caller can do other work between steps.
inline constexpr std::size_t kGcodeLinesPerStep = 256;

/// Control flow of a program: returns its lines in order of execution. Throws ProgramFault; file()
/// and line() are the position of the error.
class ProgramFlow {
 public:
  /// The arguments must outlive it. `lines_max` limits all lines.
  ProgramFlow(GcodeSource& source, GcodeParameters& parameters, std::size_t lines_max)
      : source_(source), parameters_(parameters), lines_max_(lines_max) {}
  virtual ~ProgramFlow() = default;
  ProgramFlow(const ProgramFlow&) = delete;
  ProgramFlow& operator=(const ProgramFlow&) = delete;

  /// Returns the next line to execute that is not control flow, or nullopt at the end of the text
  /// or at the closing '%'. Call again for a line without code and comment.
  virtual std::optional<GcodeLine> next() = 0;
  /// Reports that the last line has moved the tool, which resets the limit kGcodeIdleLinesMax.
  virtual void moved() { idle_ = 0; }
  /// File and line (from 1) of the last line read.
  std::size_t file() const { return at_.file; }
  std::size_t line() const { return line_; }
  std::string_view line_text() const;
  /// Whether the closing '%' has been read.
  bool ended() const { return ended_; }

 protected:
  struct Place {
    std::size_t file = 0;
    std::size_t line = 0;  ///< index of the next line to read
    friend bool operator==(const Place&, const Place&) = default;
  };
  /// Reads and counts the next line. Returns nullopt at the end of its file.
  std::optional<std::string_view> read_line();
  void count_line();

  GcodeSource& source_;
  GcodeParameters& parameters_;
  Place at_;
  std::size_t line_ = 0;
  bool started_ = false;  ///< a line with code, or the opening '%', has been read
  bool ended_ = false;

 private:
  const std::size_t lines_max_;
  std::size_t passed_ = 0, idle_ = 0;
};

}  // namespace kerf
