// SPDX-License-Identifier: Apache-2.0
#include "server/formats/gcode/reader.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "server/formats/control/compensation.h"
#include "server/formats/control/fault.h"
#include "server/formats/control/line_reader.h"
#include "server/formats/gcode/assumed_unit.h"
#include "server/formats/gcode/dialect_choice.h"
#include "server/formats/gcode/runner.h"
#include "server/formats/gcode/tool_path.h"
#include "server/formats/gcode/turning.h"
#include "server/formats/letter_case.h"
#include "server/formats/sinumerik/reader.h"
#include "server/formats/text_lines.h"
#include "server/formats/units.h"

namespace kerf {
namespace {

const std::vector<std::string> kMacroExtensions{".nc", ".cnc", ".ngc", ".tap", ".txt", ""};

std::shared_ptr<GcodeSource> source_of(const std::string& name, std::string_view text,
                                       const GcodeEnvironment& environment,
                                       const DialectRules& rules) {
  return std::make_shared<GcodeSource>(
      name, text, environment.subroutine_folders,
      rules.macros ? kMacroExtensions : std::vector<std::string>{".ngc"});
}

// Whether the program has a tool change (M6, M16) outside of comments.
bool has_tool_change(std::string_view text, const DialectRules& rules) {
  TextLines walk(text);
  while (walk.next()) {
    const std::string code = split_gcode_line(walk.line(), rules).code;
    for (const std::string_view word : {"m6", "m06", "m16"}) {
      const std::size_t at = code.find(word);
      if (at == std::string::npos) continue;
      const char next = at + word.size() < code.size() ? code[at + word.size()] : ' ';
      if (next < '0' || next > '9') return true;
    }
  }
  return false;
}

GcodeSetup setup_of(const Scene& scene, const GcodeEnvironment& environment) {
  const MachineKinematics kind = scene.machine.kinematics;
  return {.machine_name = to_string(kind),
          .axes = kind == MachineKinematics::kXyzacTrt   ? "xyzac"
                  : kind == MachineKinematics::kXyzbcTrt ? "xyzbc"
                                                         : "xyz",
          .machine_unit_mm = environment.machine_unit_mm,
          .unit_mm = environment.machine_unit_mm,
          .tool_axis_words = kind == MachineKinematics::kToolVector,
          .tools = environment.tools ? *environment.tools : tool_table_of(scene),
          .tools_of_scene = !environment.tools.has_value(),
          .rules = {},
          .changes_by_t = false,
          .absolute_centers = false,
          .offsets_are_wear = false,
          .machine_zero_known = environment.parameters.has_value()};
}

}  // namespace

std::expected<GcodeRun, ProgramError> run_gcode(
    const std::string& name, std::string_view text, const GcodeEnvironment& environment,
    GcodeSetup setup, GcodeCanon& canon, const std::function<void(const std::string&)>& warn) {
  const auto source = source_of(name, text, environment, setup.rules);
  GcodeRunner runner(source, environment, std::move(setup), canon, warn);
  try {
    while (runner.step()) continue;
  } catch (const ProgramFault& fault) {
    return std::unexpected(runner.error_of(fault));
  }
  return GcodeRun{.lines = runner.line(), .files = source->names()};
}

namespace {

// Settings of the control that a program reveals only by being impossible without them.
struct Assumptions {
  bool absolute_centers = false, offsets_are_wear = false;
  std::vector<std::string> notes;
};

/// A program before it is analyzed.
struct GcodeText {
  const std::string& name;
  std::string_view text;
  const Scene& scene;
  const GcodeEnvironment& environment;
  ProgramVisitor& visitor;
};

/// Data shared by all attempts to read a program.
struct Reading {
  std::shared_ptr<GcodeSource> source;
  const Scene& scene;
  GcodeEnvironment environment;
  GcodeSetup setup;
  std::vector<std::string> notes;
  std::string read_as;
  bool assumed_inches = false;
  std::string number;
};

class GcodeReader final : public LineReader {
 public:
  explicit GcodeReader(std::shared_ptr<const Reading> reading)
      : reading_(std::move(reading)),
        path_(reading_->scene, reading_->environment, sink_),
        runner_(reading_->source, reading_->environment, reading_->setup, path_,
                [this](const std::string& warning) { warn(warning); }) {
    program_.name = reading_->source->file(0).name;
    program_.warnings = reading_->notes;
    program_.read_as = reading_->read_as;
    program_.assumed_inches = reading_->assumed_inches;
    program_.number = reading_->number;
  }

 private:
  bool execute() override { return runner_.step(); }

  void finish() override {
    program_.lines = runner_.line();
    program_.files = reading_->source->names();
  }

  ProgramError error_of(const ProgramFault& fault) const override {
    return runner_.error_of(fault);
  }

  ProgramError error_at(MotionSink::Place place, const std::string& reason) const override {
    const GcodeFile& source = reading_->source->file(place.file);
    return ProgramError{source.name, place.line, trimmed_line(source.lines[place.line - 1]), reason,
                        std::string(reading_->setup.rules.label)};
  }

  std::shared_ptr<const Reading> reading_;
  GcodeToolPath path_;
  GcodeRunner runner_;
};

// The digits of the first O1234 or :1234 at the beginning of a line.
std::string program_number(std::string_view text) {
  constexpr std::size_t kHeadLines = 20, kNumberMax = 8;
  TextLines lines(text);
  while (lines.next() && lines.number() <= kHeadLines) {
    std::string_view line = lines.line();
    line.remove_prefix(std::min(line.find_first_not_of(" \t"), line.size()));
    if (line.empty() || (to_lower(line[0]) != 'o' && line[0] != ':')) continue;
    const std::size_t digits = std::min(line.find_first_not_of("0123456789", 1), line.size()) - 1;
    if (digits > 0 && digits <= kNumberMax) return std::string(line.substr(1, digits));
  }
  return {};
}

std::string note_of(const std::string& name, Dialect dialect, const std::string& reason) {
  return name + ": read as " + std::string(rules_of(dialect).label) + ": " + reason +
         "; --dialect names another one";
}

std::expected<ReadProgram, ProgramError> read_as(Dialect dialect, const GcodeText& program,
                                                 const std::string& reason,
                                                 const Assumptions& assumed = {}) {
  const GcodeEnvironment& environment = program.environment;
  GcodeSetup setup = setup_of(program.scene, environment);
  setup.rules = rules_of(dialect);
  setup.changes_by_t = setup.rules.macros && !has_tool_change(program.text, setup.rules);
  setup.absolute_centers = assumed.absolute_centers;
  setup.offsets_are_wear = assumed.offsets_are_wear;
  std::vector<std::string> notes = assumed.notes;
  const std::size_t inches =
      setup.rules.of_fanuc() && environment.machine_unit_mm == 1 ? line_of_inches(program.text) : 0;
  if (inches > 0) {
    setup.unit_mm = kMmPerInch;
    notes.push_back(program.name + ":" + std::to_string(inches) +
                    ": the program is read in inches: it has neither G20 nor G21, and this comment "
                    "states inches");
  }
  if (!reason.empty() && dialect != Dialect::kLinuxcnc)
    notes.insert(notes.begin(), note_of(program.name, dialect, reason));
  const std::string number = setup.rules.macros ? program_number(program.text) : "";
  std::string read_as(setup.rules.label);
  if (!reason.empty()) read_as += ": " + reason;
  const auto source = source_of(program.name, program.text, environment, setup.rules);
  const auto reading =
      std::make_shared<const Reading>(source, program.scene, environment, std::move(setup),
                                      std::move(notes), std::move(read_as), inches > 0, number);
  return read_to_end([reading] { return std::make_unique<GcodeReader>(reading); }, program.visitor);
}

bool contains(const std::string& text, std::string_view part) {
  return text.find(part) != std::string::npos;
}

// Adds the assumption that would avoid this error. Returns false if there is none.
bool assume(const ProgramError& error, Assumptions& assumed) {
  const std::string place = error.file + ":" + std::to_string(error.line) + ": ";
  const bool centers = contains(error.reason, "the radius of the arc is") ||
                       contains(error.reason, "the center of the arc is");
  if (centers && !assumed.absolute_centers && !assumed.offsets_are_wear) {
    assumed.absolute_centers = true;
    assumed.notes.push_back(place +
                            "I, J and K of all arcs are read as coordinates: relative to "
                            "their starts this is no arc");
    return true;
  }
  if (!is_compensation_fault(error.reason) || assumed.offsets_are_wear) return false;
  assumed.offsets_are_wear = true;
  assumed.notes.push_back(place +
                          "the offsets D are read as 0, as for a path of the tool's center: "
                          "the tool's radius is not possible here");
  return true;
}

// Reads for a control with Macro B, if necessary with assumptions about its settings.
std::expected<ReadProgram, ProgramError> read_macros(Dialect dialect, const GcodeText& program,
                                                     const std::string& reason) {
  if (rules_of(dialect).of_fanuc())
    if (const std::string sign = sign_of_turning(program.text); !sign.empty())
      return std::unexpected(ProgramError{program.name, 0, "",
                                          "is a program for a lathe (" + sign +
                                              "), where the workpiece turns, which is not "
                                              "supported",
                                          std::string(rules_of(dialect).label)});
  Assumptions assumed;
  auto read = read_as(dialect, program, reason);
  if (!rules_of(dialect).macros || program.environment.tools) return read;
  while (!read && assume(read.error(), assumed)) {
    auto again = read_as(dialect, program, reason, assumed);
    if (!again && again.error().line <= read.error().line) return read;
    read = std::move(again);
  }
  return read;
}

}  // namespace

std::expected<ReadProgram, ProgramError> read_gcode(const std::string& name, std::string_view text,
                                                    const Scene& scene,
                                                    const GcodeEnvironment& environment,
                                                    ProgramVisitor& visitor) {
  const GcodeText program{name, text, scene, environment, visitor};
  if (environment.dialect != Dialect::kAuto) return read_macros(environment.dialect, program, {});
  const auto choice = choose_dialect(name, text);
  if (!choice) return std::unexpected(choice.error());
  if (choice->dialect == Dialect::kSiemens)
    return read_sinumerik(name, text, scene, environment.lines_max, visitor, choice->reason);
  auto read = read_macros(choice->dialect, program, choice->reason);
  if (read || !choice->open || visitor.is_stopped()) return read;
  // No word points to LinuxCNC, and it rejects the program: try a plain Fanuc program.
  auto again = read_macros(
      Dialect::kFanuc, program,
      choice->reason + ", and LinuxCNC rejects line " + std::to_string(read.error().line));
  // Report the error of the attempt that went further.
  return again || again.error().line > read.error().line ? std::move(again) : std::move(read);
}

}  // namespace kerf
