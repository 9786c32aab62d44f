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

/// Reads a program step by step, so that only those of its motions are in memory that are needed:
/// beside the text and an index of its lines, some kilobytes, whatever its loops and cycles make of
/// it.
class ProgramReader {
 public:
  ProgramReader() = default;
  virtual ~ProgramReader() = default;
  ProgramReader(const ProgramReader&) = delete;
  ProgramReader& operator=(const ProgramReader&) = delete;

  /// Executes a line of the program, or goes on with one that makes many motions. Appends motions
  /// to those of program(), which the caller takes: about a hundred at most, often none. Returns
  /// false at the end. After an error nothing may be read any more.
  virtual std::expected<bool, ProgramError> step() = 0;
  Program& program() { return program_; }

 protected:
  Program program_;
};

/// Begins to read a program that has been read to its end before, as it was read then.
using OpenProgram = std::function<std::unique_ptr<ProgramReader>()>;

/// Receives the motions of a program that is read to its end.
class ProgramVisitor {
 public:
  virtual ~ProgramVisitor() = default;
  /// The program is read from its beginning, perhaps not for the first time: as another dialect.
  virtual void begin() = 0;
  virtual void visit(std::span<const ProgramMotion> motions) = 0;
  /// Whether the reading should end, with the error "stopped"; asked between steps.
  virtual bool is_stopped() const { return false; }
};

/// A program that could be read to its end.
struct ReadProgram {
  Program notes;  ///< without motions
  OpenProgram open;
};

/// Reads a program to its end, in the dialect of `environment` or else of the scene's machine, as
/// parse_program does, but keeps no motion. `text` and `scene` must
/// outlive what `open` of the result returns. Errors: as of parse_program.
std::expected<ReadProgram, ProgramError> read_program(const std::string& name,
                                                      std::string_view text, const Scene& scene,
                                                      const GcodeEnvironment& environment,
                                                      ProgramVisitor& visitor);

/// Returns a bound of the memory that the reading of a program takes beside its text, without what
/// the visitor keeps.
std::size_t reading_memory_bytes(std::string_view text);

/// The error of a program whose reading was stopped.
ProgramError program_stopped(const std::string& name);

/// For the readers of read_program: reads to the end what `open` returns.
std::expected<ReadProgram, ProgramError> read_to_end(OpenProgram open, ProgramVisitor& visitor);

}  // namespace kerf
