// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sched.h>

#include <atomic>

namespace kerf::agent {

/// Processor on which a real-time loop runs, for the threads that it wakes (FollowCpu).
class LeadCpu {
 public:
  /// Loop thread, each tick.
  void note() noexcept { cpu_.store(::sched_getcpu(), std::memory_order_relaxed); }
  /// Loop thread, at the end.
  void forget() noexcept { cpu_.store(-1, std::memory_order_relaxed); }
  /// From any thread. Negative while no real-time loop runs.
  int cpu() const noexcept { return cpu_.load(std::memory_order_relaxed); }

 private:
  std::atomic<int> cpu_{-1};
};

}  // namespace kerf::agent
