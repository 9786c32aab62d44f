// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "server/formats/control/canon.h"
#include "server/formats/control/fault.h"
#include "server/formats/gcode/environment.h"
#include "server/formats/gcode/machine.h"
#include "server/formats/gcode/macro_flow.h"
#include "server/formats/gcode/parameters.h"
#include "server/formats/gcode/program_flow.h"
#include "server/formats/gcode/setup.h"
#include "server/formats/gcode/source.h"
#include "server/formats/program_error.h"

namespace kerf {

/// Interprets a G-code program step by step and sends its canonical calls to a GcodeCanon.
class GcodeRunner {
 public:
  using Warn = std::function<void(const std::string&)>;

  /// `canon` must outlive it. `warn` receives each warning as "file:line: text".
  GcodeRunner(std::shared_ptr<GcodeSource> source, const GcodeEnvironment& environment,
              GcodeSetup setup, GcodeCanon& canon, Warn warn);

  /// Executes a line, a step of a cycle, or some lines of control flow. Returns false at the end of
  /// the program. Throws ProgramFault.
  bool step();
  /// The error of a fault that step() has thrown.
  ProgramError error_of(const ProgramFault& fault) const;
  /// The last line read.
  std::size_t line() const { return flow_->line(); }
  const GcodeSource& source() const { return *source_; }

 private:
  std::unique_ptr<ProgramFlow> make_flow(std::size_t lines_max);
  bool execute(const GcodeLine& line);
  bool execute_macro(const GcodeLine& line);
  void remark(const std::string& comment);
  bool go_on();
  bool close(bool by_code);
  void warn_of_trailing_lines();
  void warn_here(const std::string& warning);

  DialectRules rules_;
  std::shared_ptr<GcodeSource> source_;
  GcodeCanon& canon_;
  Warn warn_;
  GcodeParameters parameters_;
  MacroFlow* macro_flow_ = nullptr;  ///< flow_, if it is one
  std::unique_ptr<ProgramFlow> flow_;
  GcodeMachine machine_;
  std::optional<GcodeBlock> block_;      ///< the block whose motion has begun
  std::optional<MacroFlow::Call> call_;  ///< at its end
};

/// A line without the blanks around it.
std::string trimmed_line(std::string_view line);

}  // namespace kerf
