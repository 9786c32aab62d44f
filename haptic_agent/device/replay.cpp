// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/device/replay.h"

#include <utility>

#include "haptic_agent/device/units.h"
#include "server/wire/types.h"

namespace kerf::agent {

Replay::Replay(PathCursor path) : path_(std::move(path)) {}

DeviceCapabilities Replay::capabilities() const {
  return {.name = "replay", .sensed_dof = 5, .actuated_dof = 0};
}

DeviceState Replay::read(std::uint64_t now_us) noexcept {
  if (!started_) {
    started_ = true;
    start_us_ = now_us;
  }
  const PathPoint point = path_.at(static_cast<double>(now_us - start_us_) * kSPerUs);
  return {.tip_mm = point.tip_mm,
          .axis = point.axis,
          .buttons = wire::kButtonDeadman | (point.cutting ? wire::kButtonCutting : 0U),
          .tool_id = point.tool_id,
          .time_us = now_us,
          .valid = true,
          .finished = point.at_end,
          .phase = DevicePhase::kReady};
}

void Replay::write(const Wrench&) noexcept {}

}  // namespace kerf::agent
