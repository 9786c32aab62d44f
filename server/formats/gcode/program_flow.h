// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "server/formats/gcode/block.h"

namespace kerf {

/// Most consecutive lines without a motion (kGcodeLinesMax limits all lines).
inline constexpr std::size_t kGcodeIdleLinesMax = 1'000'000;
/// Lines of control flow per step, so that the caller can do other work between steps.
inline constexpr std::size_t kGcodeLinesPerStep = 256;

/// Control flow of a program: returns its lines in order of execution. Throws ProgramFault; file()
/// and line() are the position of the error.
class ProgramFlow {
 public:
  virtual ~ProgramFlow() = default;
  ProgramFlow() = default;
  ProgramFlow(const ProgramFlow&) = delete;
  ProgramFlow& operator=(const ProgramFlow&) = delete;

  /// Returns the next line to execute that is not control flow, or nullopt at the end of the text
  /// or at the closing '%'. Call again for a line without code and comment.
  virtual std::optional<GcodeLine> next() = 0;
  /// Reports that the last line has moved the tool, which resets the limit kGcodeIdleLinesMax.
  virtual void moved() = 0;
  /// File and line (from 1) of the last line read.
  virtual std::size_t file() const = 0;
  virtual std::size_t line() const = 0;
  virtual std::string_view line_text() const = 0;
  /// Whether the closing '%' has been read.
  virtual bool ended() const = 0;
};

}  // namespace kerf
