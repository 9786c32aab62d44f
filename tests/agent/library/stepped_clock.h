// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace kerf::agent {

/// The monotonic clock that libkerf_agent.so reads in this process. While it is stepped it stands
/// still between two calls of `advance_us`, however long the threads of a busy machine wait, so a
/// loop of the test loses no tick. Timers of the link and everything outside the library go on with
/// the machine's clock.
class SteppedClock {
 public:
  /// Adds to the library's clock; the first call stops it at the machine's time. Any thread.
  static void advance_us(std::uint64_t step_us);
  /// The time at which it stands, in microseconds; 0 while it runs with the machine's clock.
  static std::uint64_t now_us();
  /// Returns to the machine's clock. Only after the library's last object was closed, because its
  /// time may go back.
  static void release();
};

}  // namespace kerf::agent
