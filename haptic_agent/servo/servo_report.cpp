// SPDX-License-Identifier: Apache-2.0
// Reports each tick to the summary, the view, the sound and the recordings.
#include <algorithm>
#include <cassert>

#include "haptic_agent/servo/servo_cycle.h"

namespace kerf::agent {

void ServoCycle::note_softness(double mm_per_n) noexcept {
  if (mm_per_n > ServoReport::kSoftMmPerN) ++report_.soft_ticks;
  report_.softest_mm_per_n = std::max(report_.softest_mm_per_n, mm_per_n);
}

/// Compares the output with the computed wrench. `on`: the supervisor permits a force.
void ServoCycle::note_felt(bool on) noexcept {
  constexpr double kLeastLeverMm = 1;
  const double lever_mm = std::max(kLeastLeverMm, settings_.pivot_mm);
  share_ = felt_share(output_.released(), computed_, lever_mm);
  if (on) report_.felt.add(output_.released(), computed_, share_);
}

void ServoCycle::note(const SafetyInput& seen, const Wrench& requested) noexcept {
  report_.max_force_n = std::max(report_.max_force_n, length(output_.released().force_n));
  report_.max_torque_nmm = std::max(report_.max_torque_nmm, length(output_.released().torque_nmm));
  const Twist& velocity = velocity_.velocity();
  recorder_.note({.time_us = last_us_,
                  .tip_mm = tip_mm_,
                  .velocity_mm_per_s = velocity.linear,
                  .requested = requested,
                  .output = output_.released(),
                  .energy_mj = output_.passivity().account().level_mj(),
                  .answer_age_us = seen.answer_age_us,
                  .lost_now = lost_now_,
                  .phase = supervisor_.phase()});
  if (supervisor_.trips() != noted_trips_) recorder_.trip(supervisor_.code());
  noted_trips_ = supervisor_.trips();
  status_.write({.phase = supervisor_.phase(),
                 .code = supervisor_.code(),
                 .trips = noted_trips_,
                 .output = output_.released(),
                 .computed = computed_,
                 .energy_mj = output_.passivity().account().level_mj(),
                 .speed_mm_per_s = seen.tip_mm_per_s,
                 .answer_age_us = seen.answer_age_us,
                 .felt_share = share_,
                 .no_force = supervisor_.no_force(),
                 .lost_gain = supervisor_.lost_gain()});
  reason_.store(supervisor_.no_force(), std::memory_order_relaxed);
  ++report_.no_force_ticks[static_cast<std::size_t>(supervisor_.no_force())];
}

void ServoCycle::note_heard(const SafetyInput& seen, bool usable) noexcept {
  heard_.write(
      {.running = usable && seen.cutting && !hand_.is_away(),
       .force_n = heard_n_,
       .removed_mm3_per_s = engaged_mm2_ * seen.tip_mm_per_s * hand_.map().mapping().scale});
}

void ServoCycle::record_on(TickTape& tape) noexcept {
  const auto free = std::ranges::find(tapes_, nullptr);
  assert(free != tapes_.end());
  *free = &tape;
}

void ServoCycle::put_on_tapes(const DeviceState& tool, bool usable,
                              const SafetyInput& seen) noexcept {
  if (tapes_.front() == nullptr) return;
  const TickRecord tick{.time_us = last_us_,
                        .pose_us = tool.time_us,
                        .answer_age_us = seen.answer_age_us,
                        .tip_mm = tip_mm_,
                        .axis = measured_.grip.axis,
                        .computed = computed_,
                        .requested = seen.requested,
                        .felt = output_.released(),
                        .energy_mj = output_.passivity().account().level_mj(),
                        .felt_share = share_,
                        .buttons = tool.buttons,
                        .tool_id = tool.tool_id != 0 ? tool.tool_id : settings_.tool_id,
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
