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
constexpr std::size_t kToolsMax = 64, kDigitsMax = 6;
/// 1 less the cosine of the angle by which a retraction may lean from the tool's axis.
constexpr double kLean = 1e-6;

/// Every number behind a T or "LOADTL/", also in comments: a tool that is not used does no harm.
std::set<ToolId> numbered_tools(std::string_view text) {
  std::set<ToolId> tools;
  for (std::size_t at = 0; at < text.size() && tools.size() < kToolsMax; ++at) {
    if (text[at] != 'T' && text[at] != 't') continue;
    std::size_t from = at + 1;
    if (from + 1 < text.size() && (text[from] == 'L' || text[from] == 'l')) ++from;
    if (from > at + 1 && text[from] == '/') ++from;
    while (from < text.size() && text[from] == ' ') ++from;
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

bool is_retraction(const ProgramMotion& motion) {
  const Vec3 path = motion.to.tip_mm - motion.from.tip_mm;
  return dot(path, motion.to.axis) >= length(path) * (1 - kLean);
}

void add(std::optional<BoxStock>& box, Vec3 tip) {
  if (!box) box = BoxStock{tip, tip};
  box->min_mm = {std::min(box->min_mm.x, tip.x), std::min(box->min_mm.y, tip.y),
                 std::min(box->min_mm.z, tip.z)};
  box->max_mm = {std::max(box->max_mm.x, tip.x), std::max(box->max_mm.y, tip.y),
                 std::max(box->max_mm.z, tip.z)};
}

ProgramFacts facts_of(const Program& program, MachineKinematics kinematics) {
  ProgramFacts facts{.kinematics = kinematics, .tools = {}, .feed_mm = {}};
  std::set<ToolId> tools;
  for (const ProgramMotion& motion : program.motions) {
    tools.insert(motion.tool);
    facts.duration_s += motion.duration_s;
    if (motion.rapid || is_retraction(motion)) continue;
    const Vec3 from = motion.from.tip_mm, to = motion.to.tip_mm;
    add(facts.feed_mm, to);
    add(facts.feed_mm, {from.x, from.y, to.z});  // where a rapid may have plunged to
  }
  facts.tools.assign(tools.begin(), tools.end());
  facts.motions = program.motions.size();
  return facts;
}

}  // namespace

std::expected<ProgramFacts, ProgramError> program_facts(const std::string& name,
                                                        std::string_view text) {
  Scene scene;
  for (const ToolId id : numbered_tools(text)) {
    scene.tools[id] = {.shape = kThinTool, .body = {}, .tool = *make_tool(kThinTool)};
  }
  std::optional<ProgramError> farthest;
  for (const MachineKinematics kinematics : kMachines) {
    scene.machine.kinematics = kinematics;
    const auto program = parse_program(name, text, scene);
    if (program) return facts_of(*program, kinematics);
    if (!farthest || program.error().line > farthest->line) farthest = program.error();
  }
  return std::unexpected(*farthest);
}

}  // namespace kerf
