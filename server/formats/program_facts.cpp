// SPDX-License-Identifier: Apache-2.0
#include "server/formats/program_facts.h"

#include <algorithm>
#include <set>
#include <utility>

#include "server/formats/apt/tools.h"
#include "server/formats/letter_case.h"
#include "server/formats/machine_time.h"
#include "server/formats/program_reader.h"

namespace kerf {
namespace {

constexpr MachineKinematics kMachines[] = {MachineKinematics::kXyz, MachineKinematics::kXyzacTrt,
                                           MachineKinematics::kXyzbcTrt,
                                           MachineKinematics::kToolVector};
constexpr FlatShape kThinTool{0.1, 100};
/// The most tools of a program, and the digits of their numbers.
constexpr std::string_view kToolCall = "TOOL CALL";  ///< of Klartext
constexpr std::size_t kToolsMax = 64, kDigitsMax = 6;

std::set<ToolId> tools_of_apt(std::string_view text) {
  std::set<ToolId> tools;
  for (const auto& [id, tool] : apt_tools(text).tools) tools.insert(id);
  return tools;
}

/// Collects every number after a T outside comments. An unused tool does no harm.
std::set<ToolId> numbered_tools(std::string_view text) {
  if (is_apt(text)) return tools_of_apt(text);
  std::set<ToolId> tools;
  int depth = 0;
  bool remark = false;
  ToolId named = 0;  // tools called by name are numbered in this order
  for (std::size_t at = 0; at < text.size() && tools.size() < kToolsMax; ++at) {
    const char c = text[at];
    if (c == '\n' || c == '\r') remark = false, depth = 0;
    if (c == ';') remark = true;
    if (c == '(') ++depth;
    if (c == ')' && depth > 0) --depth;
    if (remark || depth > 0 || (c != 'T' && c != 't')) continue;
    std::size_t from = at + 1;
    if (to_upper(std::string(text.substr(at, kToolCall.size()))) == kToolCall)
      from = at + kToolCall.size();
    if (from == at + 1 && from < text.size() && text[from] == '=') ++from;  // T="MILL"
    while (from < text.size() && text[from] == ' ') ++from;
    if (from < text.size() && text[from] == '"') tools.insert(++named);
    std::size_t end = from;
    ToolId id = 0;
    for (; end < text.size() && end - from < kDigitsMax && is_digit(text[end]); ++end) {
      id = 10 * id + static_cast<ToolId>(text[end] - '0');
    }
    if (id > 0) tools.insert(id);
  }
  return tools;
}

class FactsVisitor final : public ProgramVisitor {
 public:
  explicit FactsVisitor(std::stop_token stop) : stop_(std::move(stop)) {}
  void begin() override { *this = FactsVisitor(stop_); }
  bool is_stopped() const override { return stop_.stop_requested(); }
  void visit(std::span<const ProgramMotion> motions) override {
    for (const ProgramMotion& motion : motions) {
      tools_.insert(motion.tool);
      duration_s_ += motion.duration_s;
      machine_.add(motion);
      extents_.look(motion);
    }
    motions_ += motions.size();
  }
  /// The extents need a second pass.
  std::expected<ProgramFacts, ProgramError> facts(const OpenProgram& open) {
    const auto reader = open();
    for (bool more = true; more;) {
      if (is_stopped()) return std::unexpected(program_stopped(reader->program().name));
      const auto step = reader->step();
      if (!step) return std::unexpected(step.error());
      for (const ProgramMotion& motion : reader->program().motions) extents_.add(motion);
      reader->program().motions.clear();
      more = *step;
    }
    return ProgramFacts{.kinematics = {},
                        .tools = {tools_.begin(), tools_.end()},
                        .named_tools = {},
                        .numbers_no_tool = false,
                        .cuts = extents_.result(),
                        .motions = motions_,
                        .duration_s = duration_s_,
                        .machine_s = machine_.total_s(),
                        .assumed_inches = false,
                        .spindle_tool = 0};
  }

 private:
  std::set<ToolId> tools_;
  double duration_s_ = 0;
  MachineTime machine_;
  std::size_t motions_ = 0;
  CutExtentsFinder extents_;
  std::stop_token stop_;
};

}  // namespace

std::expected<ProgramFacts, ProgramError> program_facts(const std::string& name,
                                                        std::string_view text,
                                                        const GcodeEnvironment& environment,
                                                        const std::stop_token& stop) {
  Scene scene;
  std::set<ToolId> named = numbered_tools(text);
  const bool numbers_no_tool = named.empty();
  if (numbers_no_tool) named.insert(1);
  for (const ToolId id : named) {
    scene.tools[id] = {.shape = kThinTool, .body = {}, .tool = *make_tool(kThinTool)};
  }
  // A program with one tool needs no spare tool.
  const ToolId spare = named.size() > 1 ? *named.rbegin() + 1 : 0;
  if (spare > 0) {
    scene.tools[spare] = {.shape = kThinTool, .body = {}, .tool = *make_tool(kThinTool)};
    scene.machine.spindle_tool = spare;
  }
  std::optional<ProgramError> farthest;
  for (const MachineKinematics kinematics : kMachines) {
    if (stop.stop_requested()) return std::unexpected(program_stopped(name));
    scene.machine.kinematics = kinematics;
    FactsVisitor visitor(stop);
    const auto read = read_program(name, text, scene, environment, visitor);
    if (read) {
      auto facts = visitor.facts(read->open);
      if (!facts) return facts;
      facts->kinematics = kinematics;
      facts->named_tools.assign(named.begin(), named.end());
      facts->numbers_no_tool = numbers_no_tool;
      if (std::ranges::find(facts->tools, spare) != facts->tools.end()) facts->spindle_tool = spare;
      facts->assumed_inches = read->notes.assumed_inches;
      return facts;
    }
    if (!farthest || read.error().line > farthest->line) farthest = read.error();
  }
  return std::unexpected(*farthest);
}

}  // namespace kerf
