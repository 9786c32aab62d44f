// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <expected>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "server/formats/gcode/environment.h"
#include "server/formats/program.h"
#include "server/formats/program_error.h"
#include "server/formats/scene.h"

namespace kerf {

/// Reads a program step by step, so that only the motions in use are in memory. Needs the text, an
/// index of its lines and some kilobytes, whatever its loops and cycles produce.
class ProgramReader {
 public:
  ProgramReader() = default;
  virtual ~ProgramReader() = default;
  ProgramReader(const ProgramReader&) = delete;
  ProgramReader& operator=(const ProgramReader&) = delete;

  /// Executes a line of the program, or continues one that makes many motions. Appends motions to
  /// those of program(), which the caller takes: at most about a hundred, often zero. Returns false
  /// at the end. Must not be called again after an error.
  virtual std::expected<bool, ProgramError> step() = 0;
  Program& program() { return program_; }

 protected:
  Program program_;
};

/// Starts to read a program again that has been read to its end, with the same settings.
using OpenProgram = std::function<std::unique_ptr<ProgramReader>()>;

/// Receives the motions of a program that is read to its end.
class ProgramVisitor {
 public:
  virtual ~ProgramVisitor() = default;
  /// The program is read from its beginning, possibly again, as another dialect.
  virtual void begin() = 0;
  virtual void visit(std::span<const ProgramMotion> motions) = 0;
  /// Whether to stop reading, with the error "stopped". Polled between steps.
  virtual bool is_stopped() const { return false; }
};

/// A program that could be read to its end.
struct ReadProgram {
  Program notes;  ///< without motions
  OpenProgram open;
};

/// Reads a program to its end, in the dialect of `environment` or else of the scene's machine, like
/// parse_program, but keeps no motion. `text` and `scene` must outlive the readers that `open` of
/// the result returns. Errors: those of parse_program.
std::expected<ReadProgram, ProgramError> read_program(const std::string& name,
                                                      std::string_view text, const Scene& scene,
                                                      const GcodeEnvironment& environment,
                                                      ProgramVisitor& visitor);

/// Returns a bound of the memory for reading a program, without its text and without the visitor's
/// data.
std::size_t reading_memory_bytes(std::string_view text);

/// The error of a program whose reading was stopped.
ProgramError program_stopped(const std::string& name);

/// For the readers of read_program: reads the program of `open` to its end.
std::expected<ReadProgram, ProgramError> read_to_end(OpenProgram open, ProgramVisitor& visitor);

}  // namespace kerf
