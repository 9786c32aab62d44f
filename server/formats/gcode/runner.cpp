// SPDX-License-Identifier: Apache-2.0
#include "server/formats/gcode/runner.h"

#include <utility>

#include "server/formats/gcode/flow.h"
#include "server/formats/letter_case.h"

namespace kerf {
namespace {

bool is_blank(std::string_view line) {
  return line.find_first_not_of(" \t\r%") == std::string_view::npos;
}

GcodeParameters initial(const GcodeEnvironment& environment, const DialectRules& rules) {
  GcodeParameters parameters =
      rules.macros ? GcodeParameters::of_macros(rules.vacant) : GcodeParameters();
  if (environment.parameters)
    for (const auto& [number, value] : *environment.parameters) parameters.set(number, value);
  return parameters;
}

}  // namespace

std::string trimmed_line(std::string_view line) {
  const auto first = line.find_first_not_of(" \t\r");
  const auto last = line.find_last_not_of(" \t\r");
  return first == std::string_view::npos ? std::string()
                                         : std::string(line.substr(first, last - first + 1));
}

GcodeRunner::GcodeRunner(std::shared_ptr<GcodeSource> source, const GcodeEnvironment& environment,
                         GcodeSetup setup, GcodeCanon& canon, Warn warn)
    : rules_(setup.rules),
      source_(std::move(source)),
      canon_(canon),
      warn_(std::move(warn)),
      parameters_(initial(environment, rules_)),
      flow_(make_flow(environment.lines_max)),
      machine_(std::move(setup), parameters_, canon,
               [this](const std::string& note) { warn_here(note); }) {
  canon.set_warn([this](const std::string& note) { warn_here(note); });
  if (!rules_.macros)
    parameters_.set_predefined(
        [this](const std::string& word) { return machine_.predefined(word); });
}

std::unique_ptr<ProgramFlow> GcodeRunner::make_flow(std::size_t lines_max) {
  const auto entered = [this] { machine_.enter_subroutine(); };
  const auto left = [this] { machine_.leave_subroutine(); };
  const auto readable = [this] { return machine_.position_readable(); };
  if (rules_.macros) {
    auto flow = std::make_unique<MacroFlow>(
        *source_, parameters_, rules_, lines_max,
        MacroFlow::Listener{.entered = entered,
                            .left = left,
                            .position_readable = readable,
                            .warn = [this](const std::string& note) { warn_here(note); }});
    macro_flow_ = flow.get();
    return flow;
  }
  return std::make_unique<GcodeFlow>(
      *source_, parameters_, lines_max,
      GcodeFlow::Listener{.entered = entered,
                          .left = left,
                          .returned = [this](auto value) { machine_.set_returned(value); },
                          .position_readable = readable});
}

bool GcodeRunner::step() {
  if (block_) return !go_on() || close(true);
  if (machine_.mill_on()) return flow_->moved(), true;
  machine_.at_line(flow_->file(), flow_->line());
  const auto line = flow_->next();
  if (!line) return close(false);
  if (line->code.empty() && line->comment.empty()) return true;  // control flow
  if (line->code.empty() && rules_.macros) return remark(line->comment), true;
  const bool ended = rules_.macros ? execute_macro(*line) : execute(*line);
  return !ended || close(true);
}

bool GcodeRunner::close(bool by_code) {
  machine_.finish();
  if (!by_code && !flow_->ended()) warn_here("the program ends without M2, M30 or %");
  warn_of_trailing_lines();
  return false;
}

bool GcodeRunner::execute(const GcodeLine& line) {
  const std::string comment = to_lower(trimmed_line(line.comment));
  machine_.at_line(flow_->file(), flow_->line());
  block_ = parse_gcode_block(line.code, parameters_, machine_.position_readable());
  if (comment.starts_with("abort,"))
    throw ProgramFault{"(" + line.comment + ")", "aborts the program"};
  if (comment.starts_with("py,") || comment.starts_with("pyrun,"))
    throw ProgramFault{"(" + line.comment + ")", "runs Python, which is not supported"};
  remark(line.comment);
  machine_.begin(*block_);
  return go_on();
}

void GcodeRunner::remark(const std::string& comment) {
  std::string text = trimmed_line(comment);
  if (!text.empty()) canon_.remark({.text = std::move(text)});
}

// A block of Macro B may move first and then call a subprogram.
bool GcodeRunner::execute_macro(const GcodeLine& line) {
  machine_.at_line(flow_->file(), flow_->line());
  std::string_view code = line.code;
  leading_number(code, "n", code);
  if (code == "msg" || code.starts_with("msg\"")) return false;  // shown to the operator
  if (const auto call = macro_flow_->read_macro_call(code)) return macro_flow_->execute(*call);
  block_ = parse_gcode_block(code, parameters_, machine_.position_readable(), rules_);
  call_ = MacroFlow::take_call(*block_);
  for (const auto& [group, word] : block_->codes)
    if (group == GcodeGroup::kNoEffect && word.code == 670) macro_flow_->end_modal();
  remark(line.comment);
  machine_.begin(*block_);
  return go_on();
}

// Makes a step of a cycle, or completes the block. Returns true if that ends the program.
bool GcodeRunner::go_on() {
  if (machine_.go_on()) return false;
  const bool ended = machine_.end(*block_);
  block_.reset();
  if (ended && rules_.macros) return true;
  if (machine_.moved()) flow_->moved();
  auto call = std::exchange(call_, std::nullopt);
  if (const auto outline = machine_.take_outline_program())
    call = MacroFlow::Call{.kind = MacroFlow::Call::Kind::kLocalElseSubprogram,
                           .number = *outline,
                           .arguments = {},
                           .text = "G150"};
  return ended || (call && macro_flow_->execute(*call));
}

ProgramError GcodeRunner::error_of(const ProgramFault& fault) const {
  return {source_->file(flow_->file()).name, flow_->line(),
          fault.word.empty() ? trimmed_line(flow_->line_text()) : fault.word, fault.reason,
          std::string(rules_.label)};
}

void GcodeRunner::warn_of_trailing_lines() {
  const GcodeFile& file = source_->file(0);
  if (flow_->file() != 0 || rules_.macros) return;
  for (std::size_t i = flow_->line(); i < file.lines.size(); ++i) {
    if (is_blank(file.lines[i])) continue;
    warn_(file.name + ":" + std::to_string(i + 1) +
          ": lines after the end of the program are not read");
    return;
  }
}

void GcodeRunner::warn_here(const std::string& warning) {
  warn_(source_->file(flow_->file()).name + ":" + std::to_string(flow_->line()) + ": " + warning);
}

}  // namespace kerf
