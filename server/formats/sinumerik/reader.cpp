// SPDX-License-Identifier: Apache-2.0
#include "server/formats/sinumerik/reader.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "server/formats/control/fault.h"
#include "server/formats/control/line_reader.h"
#include "server/formats/gcode/tool_path.h"
#include "server/formats/letter_case.h"
#include "server/formats/sinumerik/flow.h"
#include "server/formats/sinumerik/machine.h"

namespace kerf {
namespace {

constexpr std::string_view kLanguage = "SINUMERIK";

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

class SinumerikReader final : public LineReader {
 public:
  SinumerikReader(const std::string& name, std::shared_ptr<const SinumerikProgram> text,
                  const Scene& scene, std::size_t executed_max, bool changes_by_t,
                  const std::string& reason, const std::string& wear)
      : text_(std::move(text)),
        path_(scene, environment_, sink_),
        flow_(*text_, values_, executed_max),
        machine_(
            scene, values_, path_,
            [this](const std::string& said) { warn_once(said, flow_.line()); }, changes_by_t,
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

 private:
  bool execute() override {
    const auto line = flow_.next();
    path_.at_line(0, flow_.line());
    if (line && !machine_.execute(*line, flow_.line())) return true;
    machine_.finish();
    return false;
  }

  ProgramError error_of(const ProgramFault& fault) const override {
    const std::size_t line =
        std::clamp<std::size_t>(flow_.line(), 1, std::max<std::size_t>(text_->size(), 1));
    const std::string word = fault.word.empty() && text_->size() > 0
                                 ? std::string(text_->written(line - 1))
                                 : fault.word;
    return {program_.name, line, word, fault.reason, std::string(kLanguage)};
  }

  std::shared_ptr<const SinumerikProgram> text_;
  GcodeEnvironment environment_;  ///< without tool table and parameters, which are LinuxCNC's
  GcodeToolPath path_;
  SinumerikValues values_;
  SinumerikFlow flow_;
  SinumerikMachine machine_;
};

}  // namespace

std::expected<ReadProgram, ProgramError> read_sinumerik(const std::string& name,
                                                        std::string_view text, const Scene& scene,
                                                        std::size_t lines_max,
                                                        ProgramVisitor& visitor,
                                                        const std::string& reason) {
  try {
    const auto program = std::make_shared<const SinumerikProgram>(text);
    const std::size_t executed_max = std::min(lines_max, text.size() + kRepeatedLinesMax);
    const bool by_t = !has_tool_change(*program);
    const auto read = [&](const std::string& wear) {
      return read_to_end(
          [name, program, &scene, executed_max, by_t, reason, wear] {
            return std::make_unique<SinumerikReader>(name, program, scene, executed_max, by_t,
                                                     reason, wear);
          },
          visitor);
    };
    return read_or_assume_wear(read, name, "the offsets D are read as 0");
  } catch (const ProgramFault& fault) {
    return std::unexpected(ProgramError{name, 0, fault.word, fault.reason, std::string(kLanguage)});
  }
}

}  // namespace kerf
