// SPDX-License-Identifier: Apache-2.0
// The ticks of the cycle, as other threads record them.
#include <algorithm>
#include <cassert>

#include "haptic_agent/servo/servo_cycle.h"

namespace kerf::agent {

void ServoCycle::record_on(TickTape& tape) noexcept {
  const auto free = std::ranges::find(tapes_, nullptr);
  assert(free != tapes_.end());
  *free = &tape;
}

void ServoCycle::put_on_tapes(const DeviceState& state, bool usable,
                              const SafetyInput& seen) noexcept {
  if (tapes_.front() == nullptr) return;
  const TickRecord tick{.time_us = last_us_,
                        .pose_us = state.time_us,
                        .answer_age_us = seen.answer_age_us,
                        .tip_mm = tip_mm_,
                        .axis = measured_.grip.axis,
                        .computed = computed_,
                        .requested = seen.requested,
                        .felt = output_.released(),
                        .energy_mj = output_.passivity().account().level_mj(),
                        .felt_share = share_,
                        .buttons = state.buttons,
                        .tool_id = state.tool_id != 0 ? state.tool_id : settings_.tool_id,
                        .lost = static_cast<std::uint32_t>(lost_now_),
                        .phase = supervisor_.phase(),
                        .trip = supervisor_.code(),
                        .mode = mode_.load(std::memory_order_relaxed),
                        .has_pose = usable};
  for (TickTape* tape : tapes_) {
    if (tape != nullptr) tape->push(tick);
  }
}

}  // namespace kerf::agent
