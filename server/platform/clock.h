// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>

namespace kerf {

/// The time of the operating system. No other code in server/ reads it (tests/arch), so a test that
/// replaces clock_gettime controls all time of a server. Callable on every thread.
class Clock {
 public:
  using duration = std::chrono::steady_clock::duration;
  using time_point = std::chrono::steady_clock::time_point;

  /// Returns the monotonic time of std::chrono::steady_clock, which condition variables and timers
  /// use. It never decreases, and does not advance while the machine sleeps.
  static time_point now() noexcept;

  /// Returns the time of day in UTC, which may jump, also back.
  static std::chrono::system_clock::time_point wall() noexcept;
  /// Returns the time of day in whole ms since 1970, UTC.
  static std::int64_t wall_ms() noexcept;
  /// Returns the time of day in whole seconds since 1970, UTC.
  static std::int64_t wall_s() noexcept;

  /// Returns the CPU time of the calling thread, s.
  static double thread_cpu_s() noexcept;
  /// Returns the CPU time of all threads of this process, s.
  static double process_cpu_s() noexcept;

  /// Returns ns since boot, including time asleep. Nobody sets this clock.
  static std::int64_t boot_ns() noexcept;
};

}  // namespace kerf
