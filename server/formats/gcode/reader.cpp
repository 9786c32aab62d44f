// SPDX-License-Identifier: Apache-2.0
#include "server/formats/gcode/reader.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "server/formats/gcode/dialect_choice.h"
#include "server/formats/gcode/fault.h"
#include "server/formats/gcode/flow.h"
#include "server/formats/gcode/machine.h"
#include "server/formats/gcode/macro_flow.h"
#include "server/formats/gcode/tool_path.h"
#include "server/formats/letter_case.h"
#include "server/formats/motion_sink.h"
#include "server/formats/text_lines.h"

namespace kerf {
namespace {

using Warn = std::function<void(const std::string&)>;

std::string trimmed(std::string_view line) {
  const auto first = line.find_first_not_of(" \t\r");
  const auto last = line.find_last_not_of(" \t\r");
  return first == std::string_view::npos ? std::string()
                                         : std::string(line.substr(first, last - first + 1));
}

bool is_blank(std::string_view line) {
  return line.find_first_not_of(" \t\r%") == std::string_view::npos;
}

const std::vector<std::string> kMacroExtensions{".nc", ".cnc", ".ngc", ".tap", ".txt", ""};

class GcodeRunner {
 public:
  GcodeRunner(const std::string& name, std::string_view text, const GcodeEnvironment& environment,
              GcodeSetup setup, GcodeCanon& canon, const Warn& warn)
      : name_(name),
        rules_(setup.rules),
        source_(name, text, environment.subroutine_folders,
                rules_.macros ? kMacroExtensions : std::vector<std::string>{".ngc"}),
        warn_(warn),
        parameters_(initial(environment, rules_)),
        flow_(make_flow(environment.lines_max)),
        machine_(std::move(setup), parameters_, canon,
                 [this](const std::string& note) { warn_here(note); }) {
    canon.set_warn([this](const std::string& note) { warn_here(note); });
    if (!rules_.macros)
      parameters_.set_predefined(
          [this](const std::string& word) { return machine_.predefined(word); });
  }

  std::expected<GcodeRun, ProgramError> run() {
    try {
      bool ended = false;
      while (!ended) {
        machine_.at_line(flow_->file(), flow_->line());
        const auto line = flow_->next();
        if (!line) break;
        ended = rules_.macros ? execute_macro(*line) : execute(*line);
      }
      machine_.finish();
      if (!ended && !flow_->ended()) warn_here("the program ends without M2, M30 or %");
      warn_of_trailing_lines();
    } catch (const GcodeFault& fault) {
      return std::unexpected(
          ProgramError{source_.file(flow_->file()).name, flow_->line(),
                       fault.word.empty() ? trimmed(flow_->line_text()) : fault.word, fault.reason,
                       std::string(rules_.label)});
    }
    GcodeRun run{.lines = flow_->line(), .files = {}};
    for (std::size_t i = 0; i < source_.size(); ++i) run.files.push_back(source_.file(i).name);
    return run;
  }

 private:
  static GcodeParameters initial(const GcodeEnvironment& environment, const DialectRules& rules) {
    GcodeParameters parameters =
        rules.macros ? GcodeParameters::of_macros(rules.vacant) : GcodeParameters();
    if (environment.parameters)
      for (const auto& [number, value] : *environment.parameters) parameters.set(number, value);
    return parameters;
  }

  std::unique_ptr<ProgramFlow> make_flow(std::size_t lines_max) {
    const auto entered = [this] { machine_.enter_subroutine(); };
    const auto left = [this] { machine_.leave_subroutine(); };
    const auto readable = [this] { return machine_.position_readable(); };
    if (rules_.macros) {
      auto flow = std::make_unique<MacroFlow>(
          source_, parameters_, rules_, lines_max,
          MacroFlow::Listener{.entered = entered,
                              .left = left,
                              .position_readable = readable,
                              .warn = [this](const std::string& note) { warn_here(note); }});
      macro_flow_ = flow.get();
      return flow;
    }
    return std::make_unique<GcodeFlow>(
        source_, parameters_, lines_max,
        GcodeFlow::Listener{.entered = entered,
                            .left = left,
                            .returned = [this](auto value) { machine_.set_returned(value); },
                            .position_readable = readable});
  }

  bool execute(const GcodeLine& line) {
    const std::string comment = to_lower(trimmed(line.comment));
    machine_.at_line(flow_->file(), flow_->line());
    GcodeBlock block = parse_gcode_block(line.code, parameters_, machine_.position_readable());
    if (comment.starts_with("abort,"))
      throw GcodeFault{"(" + line.comment + ")", "aborts the program"};
    if (comment.starts_with("py,") || comment.starts_with("pyrun,"))
      throw GcodeFault{"(" + line.comment + ")", "runs Python, which is not supported"};
    const bool ended = machine_.execute(block);
    if (machine_.moved()) flow_->moved();
    return ended;
  }

  // A block of Macro B may move first and call a subprogram then.
  bool execute_macro(const GcodeLine& line) {
    machine_.at_line(flow_->file(), flow_->line());
    std::string_view code = line.code;
    leading_number(code, "n", code);
    if (code == "msg" || code.starts_with("msg\"")) return false;  // shown to the operator
    if (const auto call = macro_flow_->read_macro_call(code)) return macro_flow_->execute(*call);
    GcodeBlock block = parse_gcode_block(code, parameters_, machine_.position_readable(), rules_);
    const auto call = MacroFlow::take_call(block);
    for (const auto& [group, word] : block.codes)
      if (group == GcodeGroup::kNoEffect && word.code == 670) macro_flow_->end_modal();
    if (machine_.execute(block)) return true;
    if (machine_.moved()) macro_flow_->moved();
    return call && macro_flow_->execute(*call);
  }

  void warn_of_trailing_lines() {
    const GcodeFile& file = source_.file(0);
    if (flow_->file() != 0 || rules_.macros) return;
    for (std::size_t i = flow_->line(); i < file.lines.size(); ++i) {
      if (is_blank(file.lines[i])) continue;
      warn_(name_ + ":" + std::to_string(i + 1) +
            ": lines after the end of the program are not read");
      return;
    }
  }

  void warn_here(const std::string& warning) {
    warn_(source_.file(flow_->file()).name + ":" + std::to_string(flow_->line()) + ": " + warning);
  }

  std::string name_;
  DialectRules rules_;
  GcodeSource source_;
  const Warn& warn_;
  GcodeParameters parameters_;
  MacroFlow* macro_flow_ = nullptr;  ///< flow_, if it is one
  std::unique_ptr<ProgramFlow> flow_;
  GcodeMachine machine_;
};

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

std::expected<GcodeRun, ProgramError> run_gcode(const std::string& name, std::string_view text,
                                                const GcodeEnvironment& environment,
                                                GcodeSetup setup, GcodeCanon& canon,
                                                const Warn& warn) {
  return GcodeRunner(name, text, environment, std::move(setup), canon, warn).run();
}

namespace {

// What the settings of a control decide and a program shows only by being impossible otherwise.
struct Assumptions {
  bool absolute_centers = false, offsets_are_wear = false;
  std::vector<std::string> notes;
};

std::expected<Program, ProgramError> read_as(Dialect dialect, const std::string& name,
                                             std::string_view text, const Scene& scene,
                                             const GcodeEnvironment& environment,
                                             const std::string& note,
                                             const Assumptions& assumed = {}) {
  Program program;
  program.name = name;
  if (!note.empty()) program.warnings.push_back(note);
  program.warnings.insert(program.warnings.end(), assumed.notes.begin(), assumed.notes.end());
  MotionSink sink(program);
  const Warn warn = [&](const std::string& warning) {
    if (program.warnings.size() < kProgramWarningsMax) program.warnings.push_back(warning);
  };
  GcodeToolPath path(scene, environment, sink);
  GcodeSetup setup = setup_of(scene, environment);
  setup.rules = rules_of(dialect);
  setup.changes_by_t = setup.rules.macros && !has_tool_change(text, setup.rules);
  setup.absolute_centers = assumed.absolute_centers;
  setup.offsets_are_wear = assumed.offsets_are_wear;
  auto run = run_gcode(name, text, environment, std::move(setup), path, warn);
  if (!run) return std::unexpected(std::move(run.error()));
  program.lines = run->lines;
  program.files = std::move(run->files);
  return program;
}

std::string note_of(const std::string& name, Dialect dialect, const std::string& reason) {
  return name + ": read as " + std::string(rules_of(dialect).label) + ": " + reason +
         "; --dialect names another one";
}

bool contains(const std::string& text, std::string_view part) {
  return text.find(part) != std::string::npos;
}

// Adds the assumption without which a program has this error; false if there is none.
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
  const bool offset = contains(error.reason, "cutter compensation") ||
                      contains(error.reason, "gouging") ||
                      contains(error.reason, "the tool on its inside") ||
                      contains(error.reason, "on the side of the tool");
  if (!offset || assumed.offsets_are_wear) return false;
  assumed.offsets_are_wear = true;
  assumed.notes.push_back(place +
                          "the offsets D are read as 0, as for a path of the tool's center: "
                          "the tool's radius is not possible here");
  return true;
}

// Reads for a control with Macro B, if need be with assumptions that its settings may hold.
std::expected<Program, ProgramError> read_macros(Dialect dialect, const std::string& name,
                                                 std::string_view text, const Scene& scene,
                                                 const GcodeEnvironment& environment,
                                                 const std::string& note) {
  Assumptions assumed;
  auto program = read_as(dialect, name, text, scene, environment, note);
  if (!rules_of(dialect).macros || environment.tools) return program;
  while (!program && assume(program.error(), assumed)) {
    auto again = read_as(dialect, name, text, scene, environment, note, assumed);
    if (!again && again.error().line <= program.error().line) return program;
    program = std::move(again);
  }
  return program;
}

}  // namespace

std::expected<Program, ProgramError> read_gcode(const std::string& name, std::string_view text,
                                                const Scene& scene,
                                                const GcodeEnvironment& environment) {
  if (environment.dialect != Dialect::kAuto)
    return read_macros(environment.dialect, name, text, scene, environment, {});
  const auto choice = choose_dialect(name, text);
  if (!choice) return std::unexpected(choice.error());
  const bool plain = choice->dialect == Dialect::kLinuxcnc;
  auto program =
      read_macros(choice->dialect, name, text, scene, environment,
                  plain ? std::string() : note_of(name, choice->dialect, choice->reason));
  if (program || !choice->open) return program;
  // Nothing points to LinuxCNC, and it does not take the program: a plain Fanuc program.
  auto again = read_macros(Dialect::kFanuc, name, text, scene, environment,
                           note_of(name, Dialect::kFanuc,
                                   choice->reason + ", and LinuxCNC rejects line " +
                                       std::to_string(program.error().line)));
  // The reading that went further names the error.
  return again || again.error().line > program.error().line ? again : program;
}

}  // namespace kerf
