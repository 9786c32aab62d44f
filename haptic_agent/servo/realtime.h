#pragma once

#include <string>

namespace kerf::agent {

/// What the calling thread was given.
struct RealtimeReport {
  bool fifo = false;
  bool memory_locked = false;
  /// What was refused and what to do about it; empty if nothing was.
  std::string warning;
};

/// Above ordinary threads, below the kernel's own and a watchdog.
inline constexpr int kServoPriority = 80;
/// The link must get its samples out and its wrenches in while a machine is busy, after the servo.
inline constexpr int kLinkPriority = 60;

/// Asks for SCHED_FIFO for the calling thread; 0, or the error number of the refusal.
int request_fifo(int priority) noexcept;

/// Asks for SCHED_FIFO for the calling thread and for memory that is never paged out. A refusal is
/// reported, not fatal: the loop then runs as well as an ordinary thread can.
RealtimeReport make_realtime(int priority);

}  // namespace kerf::agent
