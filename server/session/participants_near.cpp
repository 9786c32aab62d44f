// SPDX-License-Identifier: Apache-2.0
// The part of Participants that finds the tools near that of an agent.
#include <algorithm>
#include <ranges>

#include "kernel/tool/tool_bounds.h"
#include "server/session/participants.h"

namespace kerf {
namespace {

bool meet(const Bounds& a, const Bounds& b) {
  return a.lo_mm.x <= b.hi_mm.x && b.lo_mm.x <= a.hi_mm.x && a.lo_mm.y <= b.hi_mm.y &&
         b.lo_mm.y <= a.hi_mm.y && a.lo_mm.z <= b.hi_mm.z && b.lo_mm.z <= a.hi_mm.z;
}

}  // namespace

wire::Intents Participants::near(const ParticipantState& self) const {
  struct Near {
    double distance_mm;
    const ParticipantState* state;
  };
  wire::Intents intents;
  const Tool* own = sculpture_.tool(self.track.tool());
  if (!self.intent || own == nullptr || !self.track.pose()) return intents;
  const Bounds reach = grown(tool_bounds(*own, *self.track.pose()), kIntentReachMm);
  std::vector<Near> near;
  for (const ParticipantState* state : carvers_ | std::views::values) {
    const Tool* tool = sculpture_.tool(state->track.tool());
    if (state == &self || tool == nullptr || !state->track.pose() || state->participant.is_muted ||
        state->participant.kind != ParticipantKind::kAgent) {
      continue;
    }
    if (!meet(reach, tool_bounds(*tool, *state->track.pose()))) continue;
    near.push_back({length(state->track.pose()->tip_mm - self.track.pose()->tip_mm), state});
  }
  std::ranges::sort(near, {}, &Near::distance_mm);
  for (const Near& one : near | std::views::take(wire::kMaxIntents)) {
    intents.tools[intents.count++] = {.participant = one.state->participant.id,
                                      .tool_id = one.state->track.tool(),
                                      .time_us = one.state->track.time_us(),
                                      .agent_time_us = self.newest_us,
                                      .tip_mm = one.state->track.pose()->tip_mm,
                                      .axis = Vec3f(one.state->track.pose()->axis),
                                      .status = one.state->cuts ? wire::kStatusCutting : 0};
  }
  return intents;
}

}  // namespace kerf
