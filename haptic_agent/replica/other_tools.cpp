// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/replica/other_tools.h"

#include <algorithm>
#include <ranges>

namespace kerf::agent {
namespace {

/// Those that have gone are forgotten at the agent's next sample.
constexpr std::size_t kToolsMax = 64;

}  // namespace

void OtherTools::take(const wire::Intents& intents, std::uint64_t now_us) {
  for (const wire::Intent& intent : intents.view()) {
    if (tools_.size() >= kToolsMax && !tools_.contains(intent.participant)) continue;
    tools_[intent.participant].take(intent, now_us);
  }
}

bool OtherTools::are_near(std::uint64_t now_us) {
  std::erase_if(tools_, [&](const auto& tool) { return !tool.second.is_present(now_us); });
  return !tools_.empty();
}

bool OtherTools::are_off(std::uint64_t now_us) {
  return std::ranges::any_of(tools_ | std::views::values,
                             [&](OtherTool& tool) { return tool.is_off(now_us); });
}

void OtherTools::restart() {
  for (OtherTool& tool : tools_ | std::views::values) tool.restart();
}

void OtherTools::cut(Sculpture& block, std::uint64_t now_us) {
  for (OtherTool& tool : tools_ | std::views::values) tool.cut(block, now_us);
}

}  // namespace kerf::agent
