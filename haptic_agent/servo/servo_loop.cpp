// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/servo/servo_loop.h"

#include <algorithm>

namespace kerf::agent {
namespace {
constexpr std::uint64_t kNsPerUs = 1000;
}  // namespace

void ServoLoop::put_off_alarm(std::uint64_t now_ns) noexcept {
  if (alarm_ == nullptr || alarm_ns_ >= now_ns + kStaleNs) return;
  alarm_ns_ = now_ns + kStaleNs + kAlarmSlackNs;
  alarm_->set(alarm_ns_);
}

void ServoLoop::run(ServoTask& task) noexcept {
  std::uint64_t due_ns = clock_.now_ns() + kPeriodNs;
  std::uint64_t last_ns = 0;
  while (!stop_.load(std::memory_order_relaxed)) {
    clock_.sleep_until_ns(due_ns);
    const std::uint64_t now_ns = clock_.now_ns();
    const std::uint64_t behind_ns = now_ns > due_ns ? now_ns - due_ns : 0;
    // Run only the newest of the overdue ticks.
    const std::uint64_t lost = behind_ns / kPeriodNs;
    put_off_alarm(now_ns);
    heartbeat_ns_.store(now_ns);
    if (lead_ != nullptr) lead_->note();
    stats_.lost += lost;
    stats_.most_lost_at_once = std::max(stats_.most_lost_at_once, lost);
    stats_.late += behind_ns > kLateNs ? 1 : 0;
    stats_.wake_us.add(behind_ns / kNsPerUs);
    if (last_ns != 0) {
      stats_.longest_gap_us = std::max(stats_.longest_gap_us, (now_ns - last_ns) / kNsPerUs);
    }
    last_ns = now_ns;
    const bool more = task.tick(now_ns / kNsPerUs);
    ++stats_.ticks;
    stats_.longest_tick_us =
        std::max(stats_.longest_tick_us, (clock_.now_ns() - now_ns) / kNsPerUs);
    if (!more) break;
    due_ns += (lost + 1) * kPeriodNs;
  }
  if (lead_ != nullptr) lead_->forget();
}

}  // namespace kerf::agent
