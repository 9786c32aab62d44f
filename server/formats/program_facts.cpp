// SPDX-License-Identifier: Apache-2.0
#include "server/formats/program_facts.h"

#include <algorithm>
#include <set>

#include "server/formats/letter_case.h"

namespace kerf {
namespace {

constexpr MachineKinematics kMachines[] = {MachineKinematics::kXyz, MachineKinematics::kXyzacTrt,
                                           MachineKinematics::kXyzbcTrt,
                                           MachineKinematics::kToolVector};
constexpr FlatShape kThinTool{0.1, 100};
/// The most tools of a program, and the digits of their numbers.
constexpr std::string_view kToolCall = "TOOL CALL";  ///< of Klartext
constexpr std::size_t kToolsMax = 64, kDigitsMax = 6;

/// Every number behind a T or "LOADTL/" outside of comments: a tool that is not used does no harm.
std::set<ToolId> numbered_tools(std::string_view text) {
  std::set<ToolId> tools;
  int depth = 0;
  bool remark = false;
  ToolId named = 0;  // tools called by name are numbered in this order
  for (std::size_t at = 0; at < text.size() && tools.size() < kToolsMax; ++at) {
    const char c = text[at];
    if (c == '\n') remark = false, depth = 0;
    if (c == ';') remark = true;
    if (c == '(') ++depth;
    if (c == ')' && depth > 0) --depth;
    if (remark || depth > 0 || (c != 'T' && c != 't')) continue;
    std::size_t from = at + 1;
    if (to_upper(std::string(text.substr(at, kToolCall.size()))) == kToolCall)
      from = at + kToolCall.size();
    if (from + 1 < text.size() && (text[from] == 'L' || text[from] == 'l')) ++from;
    if (from > at + 1 && text[from] == '/') ++from;
    while (from < text.size() && text[from] == ' ') ++from;
    if (from < text.size() && text[from] == '"') tools.insert(++named);
    std::size_t end = from;
    ToolId id = 0;
    for (; end < text.size() && end - from < kDigitsMax && is_digit(text[end]); ++end) {
      id = 10 * id + static_cast<ToolId>(text[end] - '0');
    }
    if (id > 0) tools.insert(id);
  }
  if (tools.empty()) tools.insert(1);
  return tools;
}

ProgramFacts facts_of(const Program& program, MachineKinematics kinematics,
                      const std::set<ToolId>& named) {
  ProgramFacts facts{.kinematics = kinematics, .tools = {}, .named_tools = {}, .cuts = {}};
  std::set<ToolId> tools;
  for (const ProgramMotion& motion : program.motions) {
    tools.insert(motion.tool);
    facts.duration_s += motion.duration_s;
  }
  facts.tools.assign(tools.begin(), tools.end());
  facts.named_tools.assign(named.begin(), named.end());
  facts.cuts = cut_extents(program.motions);
  facts.motions = program.motions.size();
  return facts;
}

}  // namespace

std::expected<ProgramFacts, ProgramError> program_facts(const std::string& name,
                                                        std::string_view text,
                                                        const GcodeEnvironment& environment) {
  Scene scene;
  const std::set<ToolId> named = numbered_tools(text);
  for (const ToolId id : named) {
    scene.tools[id] = {.shape = kThinTool, .body = {}, .tool = *make_tool(kThinTool)};
  }
  std::optional<ProgramError> farthest;
  for (const MachineKinematics kinematics : kMachines) {
    scene.machine.kinematics = kinematics;
    const auto program = parse_program(name, text, scene, environment);
    if (program) return facts_of(*program, kinematics, named);
    if (!farthest || program.error().line > farthest->line) farthest = program.error();
  }
  return std::unexpected(*farthest);
}

}  // namespace kerf
