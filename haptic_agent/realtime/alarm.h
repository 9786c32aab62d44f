// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace kerf::agent {

/// A kernel timer that one thread keeps postponing and another waits for. Postponing wakes no
/// thread and costs a tenth of waking a thread that checks a clock.
class Alarm {
 public:
  /// If the process may not open more files, `wait` returns every 5 ms instead.
  Alarm() noexcept;
  ~Alarm();
  Alarm(const Alarm&) = delete;
  Alarm& operator=(const Alarm&) = delete;

  /// Sets the alarm to `time_ns` of CLOCK_MONOTONIC, replacing the previous time. Does not wait or
  /// allocate.
  void set(std::uint64_t time_ns) noexcept;
  /// Waits until the alarm has gone off since the last `set`, or `end` was called. Call from one
  /// thread only.
  void wait() noexcept;
  /// Ends the current and all later calls of `wait`. From any thread.
  void end() noexcept;

 private:
  int timer_, ended_;
};

}  // namespace kerf::agent
