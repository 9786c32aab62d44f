// SPDX-License-Identifier: Apache-2.0
#include "server/formats/gcode/reader.h"

#include <algorithm>
#include <utility>

#include "server/formats/gcode/fault.h"
#include "server/formats/gcode/flow.h"
#include "server/formats/gcode/machine.h"
#include "server/formats/gcode/tool_path.h"
#include "server/formats/letter_case.h"
#include "server/formats/motion_sink.h"

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

class GcodeRunner {
 public:
  GcodeRunner(const std::string& name, std::string_view text, const GcodeEnvironment& environment,
              GcodeSetup setup, GcodeCanon& canon, const Warn& warn)
      : name_(name),
        source_(name, text, environment.subroutine_folders),
        warn_(warn),
        parameters_(initial(environment)),
        flow_(source_, parameters_, environment.lines_max,
              {.entered = [this] { machine_.enter_subroutine(); },
               .left = [this] { machine_.leave_subroutine(); },
               .returned = [this](auto value) { machine_.set_returned(value); },
               .position_readable = [this] { return machine_.position_readable(); }}),
        machine_(std::move(setup), parameters_, canon,
                 [this](const std::string& note) { warn_here(note); }) {
    canon.set_warn([this](const std::string& note) { warn_here(note); });
    parameters_.set_predefined(
        [this](const std::string& word) { return machine_.predefined(word); });
  }

  std::expected<GcodeRun, ProgramError> run() {
    try {
      bool ended = false;
      while (!ended) {
        machine_.at_line(flow_.file(), flow_.line());
        const auto line = flow_.next();
        if (!line) break;
        ended = execute(*line);
      }
      machine_.finish();
      if (!ended && !flow_.ended()) warn_here("the program ends without M2, M30 or %");
      warn_of_trailing_lines();
    } catch (const GcodeFault& fault) {
      return std::unexpected(ProgramError{
          source_.file(flow_.file()).name, flow_.line(),
          fault.word.empty() ? trimmed(flow_.line_text()) : fault.word, fault.reason, "LinuxCNC"});
    }
    GcodeRun run{.lines = flow_.line(), .files = {}};
    for (std::size_t i = 0; i < source_.size(); ++i) run.files.push_back(source_.file(i).name);
    return run;
  }

 private:
  static GcodeParameters initial(const GcodeEnvironment& environment) {
    GcodeParameters parameters;
    if (environment.parameters)
      for (const auto& [number, value] : *environment.parameters) parameters.set(number, value);
    return parameters;
  }

  bool execute(const GcodeLine& line) {
    const std::string comment = to_lower(trimmed(line.comment));
    machine_.at_line(flow_.file(), flow_.line());
    GcodeBlock block = parse_gcode_block(line.code, parameters_, machine_.position_readable());
    if (comment.starts_with("abort,"))
      throw GcodeFault{"(" + line.comment + ")", "aborts the program"};
    if (comment.starts_with("py,") || comment.starts_with("pyrun,"))
      throw GcodeFault{"(" + line.comment + ")", "runs Python, which is not supported"};
    const bool ended = machine_.execute(block);
    if (machine_.moved()) flow_.moved();
    return ended;
  }

  void warn_of_trailing_lines() {
    const GcodeFile& file = source_.file(0);
    if (flow_.file() != 0) return;
    for (std::size_t i = flow_.line(); i < file.lines.size(); ++i) {
      if (is_blank(file.lines[i])) continue;
      warn_(name_ + ":" + std::to_string(i + 1) +
            ": lines after the end of the program are not read");
      return;
    }
  }

  void warn_here(const std::string& warning) {
    warn_(source_.file(flow_.file()).name + ":" + std::to_string(flow_.line()) + ": " + warning);
  }

  std::string name_;
  GcodeSource source_;
  const Warn& warn_;
  GcodeParameters parameters_;
  GcodeFlow flow_;
  GcodeMachine machine_;
};

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
          .machine_zero_known = environment.parameters.has_value()};
}

}  // namespace

std::expected<GcodeRun, ProgramError> run_gcode(const std::string& name, std::string_view text,
                                                const GcodeEnvironment& environment,
                                                GcodeSetup setup, GcodeCanon& canon,
                                                const Warn& warn) {
  return GcodeRunner(name, text, environment, std::move(setup), canon, warn).run();
}

std::expected<Program, ProgramError> read_gcode(const std::string& name, std::string_view text,
                                                const Scene& scene,
                                                const GcodeEnvironment& environment) {
  Program program;
  program.name = name;
  MotionSink sink(program);
  const Warn warn = [&](const std::string& warning) {
    if (program.warnings.size() < kProgramWarningsMax) program.warnings.push_back(warning);
  };
  GcodeToolPath path(scene, environment, sink);
  auto run = run_gcode(name, text, environment, setup_of(scene, environment), path, warn);
  if (!run) return std::unexpected(std::move(run.error()));
  program.lines = run->lines;
  program.files = std::move(run->files);
  return program;
}

}  // namespace kerf
