// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace kerf::agent {

/// What the calling thread was given.
struct RealtimeReport {
  bool fifo = false;
  bool memory_locked = false;
  bool pinned = false;
  /// What was rejected and what to do about it; empty if nothing was.
  std::string warning;
};

/// The watchdog must run while the servo does not end.
inline constexpr int kWatchdogPriority = 90;
/// Above ordinary threads, below the kernel's own and the watchdog.
inline constexpr int kServoPriority = 80;
/// The copy of the block must answer before the next tick, and never delay one.
inline constexpr int kReplicaPriority = 70;
/// The link must get its samples out and its wrenches in while a machine is busy, after the servo.
inline constexpr int kLinkPriority = 60;

/// What a thread asks for.
struct RealtimeWish {
  int priority = kServoPriority;
  /// The processor to stay on, from 0; below 0: any.
  int cpu = -1;
};

/// Asks for SCHED_FIFO for the calling thread; 0, or the error number of the rejection.
int request_fifo(int priority) noexcept;

/// Asks for SCHED_FIFO and a processor for the calling thread, and for memory that is never paged
/// out, and touches the stack that the thread will use. A rejection is reported, not fatal: the
/// loop then runs as well as an ordinary thread can.
RealtimeReport make_realtime(const RealtimeWish& wish);

}  // namespace kerf::agent
