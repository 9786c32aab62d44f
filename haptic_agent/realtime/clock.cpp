// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/realtime/clock.h"

#include <cerrno>

namespace kerf::agent {
namespace {
constexpr std::uint64_t kNsPerS = 1'000'000'000;
}  // namespace

std::uint64_t MonotonicClock::now_ns() noexcept { return monotonic_ns(); }

void MonotonicClock::sleep_until_ns(std::uint64_t time_ns) noexcept {
  const timespec until{.tv_sec = static_cast<time_t>(time_ns / kNsPerS),
                       .tv_nsec = static_cast<long>(time_ns % kNsPerS)};
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr) == EINTR) {
  }
}

}  // namespace kerf::agent
