// SPDX-License-Identifier: Apache-2.0
#include "server/formats/sinumerik/reader.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <set>
#include <utility>

#include "server/formats/control/fault.h"
#include "server/formats/gcode/compensation.h"
#include "server/formats/gcode/tool_path.h"
#include "server/formats/letter_case.h"
#include "server/formats/motion_sink.h"
#include "server/formats/sinumerik/flow.h"
#include "server/formats/sinumerik/machine.h"

namespace kerf {
namespace {

/// Most lines executed beyond the size of a program, in loops.
constexpr std::size_t kRepeatedMax = 1'000'000;
constexpr std::string_view kLanguage = "SINUMERIK";
/// Pieces of a path per step.
constexpr int kPiecesPerStep = 64;

// Whether there is an M6 outside comments.
bool has_tool_change(const SinumerikProgram& program) {
  for (std::size_t n = 0; n < program.size(); ++n) {
    const std::string text = program.line(n).text;
    for (std::size_t at = text.find('M'); at != std::string::npos; at = text.find('M', at + 1)) {
      std::size_t digit = at + 1;
      if (digit < text.size() && text[digit] == '0') ++digit;
      const bool starts = at == 0 || !is_sinumerik_name(text[at - 1]) || is_digit(text[at - 1]);
      const bool ends = digit + 1 >= text.size() || !is_digit(text[digit + 1]);
      if (starts && ends && digit < text.size() && text[digit] == '6') return true;
    }
  }
  return false;
}

class SinumerikReader final : public ProgramReader {
 public:
  SinumerikReader(const std::string& name, std::shared_ptr<const SinumerikProgram> text,
                  const Scene& scene, std::size_t executed_max, bool changes_by_t,
                  const std::string& reason, const std::string& wear)
      : text_(std::move(text)),
        sink_(program_),
        path_(scene, environment_, sink_),
        flow_(*text_, values_, executed_max),
        machine_(
            scene, values_, path_, [this](const std::string& said) { warn(said); }, changes_by_t,
            !wear.empty()) {
    program_.name = name;
    program_.read_as = std::string(kLanguage) + (reason.empty() ? "" : ": " + reason);
    program_.files = {name};
    program_.lines = text_->size();
    if (!reason.empty())
      program_.warnings.push_back(name + ": read as SINUMERIK: " + reason +
                                  "; --dialect names another one");
    if (!wear.empty()) program_.warnings.push_back(wear);
  }

  std::expected<bool, ProgramError> step() override {
    if (sink_.waits()) {
      if (auto error = follow_path()) return std::unexpected(*std::move(error));
    } else if (auto error = execute()) {
      while (sink_.waits()) {  // pending motions precede the fault, and may be invalid too
        if (auto earlier = follow_path()) return std::unexpected(*std::move(earlier));
        program_.motions.clear();
      }
      return std::unexpected(*std::move(error));
    }
    return runs_ || sink_.waits();
  }

 private:
  std::optional<ProgramError> execute() {
    try {
      const auto line = flow_.next();
      path_.at_line(0, flow_.line());
      runs_ = line && !machine_.execute(*line, flow_.line());
      if (!runs_) machine_.finish();
    } catch (const ProgramFault& fault) {
      return error(fault.word, fault.reason);
    }
    return std::nullopt;
  }

  std::optional<ProgramError> follow_path() {
    const auto followed = sink_.go_on(kPiecesPerStep);
    return followed ? std::nullopt : std::optional(error({}, followed.error()));
  }

  ProgramError error(const std::string& word, std::string reason) const {
    const std::size_t line =
        std::clamp<std::size_t>(flow_.line(), 1, std::max<std::size_t>(text_->size(), 1));
    const std::string shown =
        word.empty() && text_->size() > 0 ? std::string(text_->written(line - 1)) : word;
    return {program_.name, line, shown, std::move(reason), std::string(kLanguage)};
  }

  void warn(const std::string& text) {
    if (program_.warnings.size() >= kProgramWarningsMax || !warned_.insert(text).second) return;
    program_.warnings.push_back(program_.name + ":" + std::to_string(flow_.line()) + ": " + text);
  }

  std::shared_ptr<const SinumerikProgram> text_;
  GcodeEnvironment environment_;  ///< without tool table and parameters, which are LinuxCNC's
  MotionSink sink_;
  GcodeToolPath path_;
  SinumerikValues values_;
  SinumerikFlow flow_;
  std::set<std::string> warned_;
  SinumerikMachine machine_;
  bool runs_ = true;
};

}  // namespace

std::expected<ReadProgram, ProgramError> read_sinumerik(const std::string& name,
                                                        std::string_view text, const Scene& scene,
                                                        std::size_t lines_max,
                                                        ProgramVisitor& visitor,
                                                        const std::string& reason) {
  try {
    const auto program = std::make_shared<const SinumerikProgram>(text);
    const std::size_t executed_max = std::min(lines_max, text.size() + kRepeatedMax);
    const bool by_t = !has_tool_change(*program);
    const auto read = [&](const std::string& wear) {
      return read_to_end(
          [name, program, &scene, executed_max, by_t, reason, wear] {
            return std::make_unique<SinumerikReader>(name, program, scene, executed_max, by_t,
                                                     reason, wear);
          },
          visitor);
    };
    auto first = read({});
    if (first || !is_compensation_fault(first.error().reason)) return first;
    // As with Fanuc, the path may be that of the tool's center.
    auto again = read(name + ":" + std::to_string(first.error().line) +
                      ": the offsets D are read as 0, as for a path of the tool's center: the "
                      "tool's radius is not possible here");
    return again || again.error().line > first.error().line ? std::move(again) : std::move(first);
  } catch (const ProgramFault& fault) {
    return std::unexpected(ProgramError{name, 0, fault.word, fault.reason, std::string(kLanguage)});
  }
}

}  // namespace kerf
