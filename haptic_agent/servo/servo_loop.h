// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>

#include "haptic_agent/servo/histogram.h"
#include "haptic_agent/servo/servo_clock.h"

namespace kerf::agent {

/// What a periodic loop reports. Due ticks = ticks + lost, so a tick that never ran still counts.
struct CycleStats {
  std::uint64_t ticks = 0;
  /// Ticks that started later than ServoLoop::kLateNs after they were due.
  std::uint64_t late = 0;
  /// Ticks that were due and never ran, because the loop was a whole period behind.
  std::uint64_t lost = 0;
  /// The most of them between two ticks that ran.
  std::uint64_t most_lost_at_once = 0;
  std::uint64_t longest_gap_us = 0;
  /// Time spent inside the longest tick.
  std::uint64_t longest_tick_us = 0;
  /// From when a tick was due to when it started.
  Histogram wake_us;
};

/// What happens in each tick. Called from one thread; must return well within the period.
class ServoTask {
 public:
  virtual ~ServoTask() = default;
  /// False ends the loop after this tick.
  virtual bool tick(std::uint64_t now_us) noexcept = 0;
};

/// Runs a task at a fixed rate. A loop that falls behind skips whole periods and counts them,
/// instead of running several ticks at once, in which a hand would feel several milliseconds in
/// one.
class ServoLoop {
 public:
  static constexpr std::uint64_t kPeriodNs = 1'000'000;
  static constexpr std::uint64_t kLateNs = kPeriodNs / 4;

  explicit ServoLoop(ServoClock& clock) noexcept : clock_(clock) {}

  /// Returns when the task wants no more ticks or `stop` was called.
  void run(ServoTask& task) noexcept;
  /// From any thread, or from a signal handler.
  void stop() noexcept { stop_.store(true, std::memory_order_relaxed); }

  /// When the newest tick started, ns on the loop's clock; 0 before the first. From any thread:
  /// what a watchdog looks at.
  std::uint64_t heartbeat_ns() const noexcept { return heartbeat_ns_.load(); }
  /// Read it when `run` has returned, or within a tick.
  const CycleStats& stats() const noexcept { return stats_; }

 private:
  ServoClock& clock_;
  std::atomic<bool> stop_{false};
  std::atomic<std::uint64_t> heartbeat_ns_{0};
  CycleStats stats_;
};

}  // namespace kerf::agent
