// SPDX-License-Identifier: Apache-2.0
#include "server/formats/program_reader.h"

#include <algorithm>
#include <utility>

#include "server/formats/apt/reader.h"
#include "server/formats/apt/statement.h"
#include "server/formats/gcode/reader.h"
#include "server/formats/heidenhain/blocks.h"
#include "server/formats/heidenhain/reader.h"
#include "server/formats/sinumerik/reader.h"

namespace kerf {
namespace {

/// Samples, parameters and modes. Tool changes and remarks, usually few, are extra.
constexpr std::size_t kReadingBytes = std::size_t{4} << 20;
/// Bytes per indexed line: its offset, and its sequence number or block.
constexpr std::size_t kLineBytes = 24;

bool cuts(const ProgramMotion& motion) { return !motion.rapid && !(motion.from == motion.to); }

// A program that cuts nothing is rarely intended, so this warning comes first.
void warn_of_idle_program(Program& program) {
  program.warnings.insert(program.warnings.begin(),
                          program.name + ": THE PROGRAM CUTS NOTHING: it ends after " +
                              std::to_string(program.lines) + " lines without a cutting motion");
}

class Collector final : public ProgramVisitor {
 public:
  void begin() override { motions_ = {}; }
  void visit(std::span<const ProgramMotion> motions) override {
    motions_.insert(motions_.end(), motions.begin(), motions.end());
  }
  std::vector<ProgramMotion> take() { return std::move(motions_); }

 private:
  std::vector<ProgramMotion> motions_;
};

}  // namespace

ProgramError program_stopped(const std::string& name) {
  return {.file = name, .line = 0, .word = {}, .reason = "was not read to its end: stopped"};
}

std::size_t reading_memory_bytes(std::string_view text) {
  return kReadingBytes + kLineBytes * static_cast<std::size_t>(std::ranges::count(text, '\n'));
}

std::expected<ReadProgram, ProgramError> read_to_end(OpenProgram open, ProgramVisitor& visitor) {
  const auto reader = open();
  Program& program = reader->program();
  visitor.begin();
  bool cuts_any = false;
  while (true) {
    if (visitor.is_stopped()) return std::unexpected(program_stopped(program.name));
    const auto more = reader->step();
    if (!more) return std::unexpected(more.error());
    if (!program.motions.empty()) {
      visitor.visit(program.motions);
      cuts_any = cuts_any || std::ranges::any_of(program.motions, cuts);
      program.motions.clear();
    }
    if (!*more) break;
  }
  program.motions = {};
  if (!cuts_any) warn_of_idle_program(program);
  return ReadProgram{std::move(program), std::move(open)};
}

std::expected<ReadProgram, ProgramError> read_program(const std::string& name,
                                                      std::string_view text, const Scene& scene,
                                                      const GcodeEnvironment& environment,
                                                      ProgramVisitor& visitor) {
  const auto format = program_format(name);
  if (!format) return std::unexpected(format.error());
  // Some editors write a byte order mark before the first word.
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  GcodeEnvironment chosen = environment;
  if (chosen.dialect == Dialect::kAuto) chosen.dialect = scene.machine.dialect;
  const bool apt = chosen.dialect == Dialect::kAuto && is_apt(text);
  if (*format == ProgramFormat::kApt || apt) return read_apt(name, text, scene, visitor);
  const bool klartext = chosen.dialect == Dialect::kHeidenhain ||
                        (chosen.dialect == Dialect::kAuto && is_klartext(text));
  if (klartext) return read_klartext(name, text, scene, environment.lines_max, visitor);
  if (chosen.dialect == Dialect::kSiemens)
    return read_sinumerik(name, text, scene, environment.lines_max, visitor);
  return read_gcode(name, text, scene, chosen, visitor);
}

std::expected<Program, ProgramError> parse_program(const std::string& name, std::string_view text,
                                                   const Scene& scene,
                                                   const GcodeEnvironment& environment) {
  Collector collector;
  auto read = read_program(name, text, scene, environment, collector);
  if (!read) return std::unexpected(std::move(read.error()));
  read->notes.motions = collector.take();
  return std::move(read->notes);
}

}  // namespace kerf
