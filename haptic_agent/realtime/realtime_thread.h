// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>

namespace kerf::agent {

/// Permissions that the operating system granted to a thread.
struct RealtimeReport {
  bool fifo = false;
  bool memory_locked = false;
  bool pinned = false;
  /// The denied permissions and how to allow them. Empty if all were granted.
  std::string warning;
};

/// Above the servo, so that the watchdog runs even if a servo tick never returns.
inline constexpr int kWatchdogPriority = 90;
/// Above ordinary threads, below the kernel's own threads and the watchdog.
inline constexpr int kServoPriority = 80;
/// The replica must answer before the next tick, and must not delay one.
inline constexpr int kReplicaPriority = 70;
/// Below the servo: the link must send samples and receive wrenches even on a busy machine.
inline constexpr int kLinkPriority = 60;

struct RealtimeRequest {
  int priority = kServoPriority;
  /// Processor to pin the thread to, from 0. Negative for no pinning.
  int cpu = -1;
};

/// Stack size of the threads of kerf-agent: far more than any of them uses.
inline constexpr std::size_t kThreadStackBytes = std::size_t{1024} * 1024;
/// Gives threads created later a stack of kThreadStackBytes. Locked memory is resident, including
/// unused stacks, which have 8 MiB each by default. For programs, not for libraries. Returns 0 or
/// an error number.
int limit_thread_stacks() noexcept;

/// Requests SCHED_FIFO for the calling thread. Returns 0 or an error number.
int request_fifo(int priority) noexcept;

/// Requests SCHED_FIFO and a processor for the calling thread, locks the process's memory, and
/// touches the stack that the thread will use. Denied requests are reported and not fatal: the loop
/// then runs as an ordinary thread.
RealtimeReport make_realtime(const RealtimeRequest& request);

}  // namespace kerf::agent
