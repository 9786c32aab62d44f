// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>

#include "haptic_agent/realtime/alarm.h"
#include "haptic_agent/realtime/clock.h"
#include "haptic_agent/realtime/histogram.h"
#include "haptic_agent/realtime/lead_cpu.h"

namespace kerf::agent {

/// Statistics of a periodic loop. Due ticks = ticks + lost.
struct CycleStats {
  std::uint64_t ticks = 0;
  /// Ticks that started more than ServoLoop::kLateNs after they were due.
  std::uint64_t late = 0;
  /// Ticks that were skipped because the loop was at least one period behind.
  std::uint64_t lost = 0;
  /// Greatest number of ticks skipped in a row.
  std::uint64_t most_lost_at_once = 0;
  std::uint64_t longest_gap_us = 0;
  /// Duration of the longest tick.
  std::uint64_t longest_tick_us = 0;
  /// Wake-up latency: from the time at which a tick was due until it started.
  Histogram wake_us;
};

/// Work of each tick. Called from one thread. Must return well within the period.
class ServoTask {
 public:
  virtual ~ServoTask() = default;
  /// Returns false to end the loop after this tick.
  virtual bool tick(std::uint64_t now_us) noexcept = 0;
};

/// Runs a task at a fixed rate. A loop that falls behind skips whole periods and counts them,
/// instead of running the missed ticks in a burst.
class ServoLoop {
 public:
  static constexpr std::uint64_t kPeriodNs = 1'000'000;
  static constexpr std::uint64_t kLateNs = kPeriodNs / 4;
  /// Age of a heartbeat after which the loop has stalled.
  static constexpr std::uint64_t kStaleNs = 10'000'000;
  /// Slack that saves setting the alarm again in every tick.
  static constexpr std::uint64_t kAlarmSlackNs = kPeriodNs * 3 / 2;

  explicit ServoLoop(Clock& clock) noexcept : clock_(clock) {}

  /// Returns when the task ends the loop or `stop` was called.
  void run(ServoTask& task) noexcept;
  /// From any thread, or from a signal handler.
  void stop() noexcept { stop_.store(true, std::memory_order_relaxed); }

  /// Start of the newest tick, ns on the loop's clock, or 0 before the first. From any thread;
  /// checked by the watchdog.
  std::uint64_t heartbeat_ns() const noexcept { return heartbeat_ns_.load(); }
  /// Publishes the loop's processor from now on. Call before `run`, or on its thread, and only if
  /// that is real-time; `lead` must outlive the run.
  void announce(LeadCpu& lead) noexcept { lead_ = &lead; }
  /// Keeps `alarm` set from now on, to go off kStaleNs after the newest heartbeat, or up to
  /// kAlarmSlackNs later. The alarm is set before the heartbeat, so a thread that sees a new
  /// heartbeat may wait for the alarm again. Call before `run`; `alarm` must outlive it.
  void set_off_without_heartbeat(Alarm& alarm) noexcept { alarm_ = &alarm; }
  /// Read after `run` has returned, or within a tick.
  const CycleStats& stats() const noexcept { return stats_; }

 private:
  void put_off_alarm(std::uint64_t now_ns) noexcept;

  Clock& clock_;
  std::atomic<bool> stop_{false};
  std::atomic<std::uint64_t> heartbeat_ns_{0};
  LeadCpu* lead_ = nullptr;
  Alarm* alarm_ = nullptr;
  std::uint64_t alarm_ns_ = 0;  ///< time for which the alarm is set
  CycleStats stats_;
};

}  // namespace kerf::agent
