// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/realtime/clock.h"

#include <cerrno>

namespace kerf::agent {

std::uint64_t MonotonicClock::now_ns() noexcept { return monotonic_ns(); }

void MonotonicClock::sleep_until_ns(std::uint64_t time_ns) noexcept {
  const timespec until = timespec_of(time_ns);
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr) == EINTR) {
  }
}

}  // namespace kerf::agent
