// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace kerf::agent {

/// The monotonic clock that libkerf_agent.so reads in this process. While stepped, it advances only
/// by `advance_us`, however long the threads of a busy machine wait, so a loop of the test loses no
/// tick. Timers of the link and everything outside the library follow the machine's clock.
class SteppedClock {
 public:
  /// Advances the library's clock. The first call stops it at the machine's time. From any thread.
  static void advance_us(std::uint64_t step_us);
  /// The stepped time in microseconds, or 0 while the clock follows the machine's.
  static std::uint64_t now_us();
  /// Returns to the machine's clock. Call only after the library's last object was closed, because
  /// its time may go back.
  static void release();
};

}  // namespace kerf::agent
