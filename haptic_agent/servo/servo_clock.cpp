// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/servo/servo_clock.h"

#include <cerrno>
#include <ctime>

namespace kerf::agent {
namespace {
constexpr std::uint64_t kNsPerS = 1'000'000'000;
}  // namespace

std::uint64_t MonotonicClock::now_ns() noexcept {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return static_cast<std::uint64_t>(now.tv_sec) * kNsPerS + static_cast<std::uint64_t>(now.tv_nsec);
}

void MonotonicClock::sleep_until_ns(std::uint64_t time_ns) noexcept {
  const timespec until{.tv_sec = static_cast<time_t>(time_ns / kNsPerS),
                       .tv_nsec = static_cast<long>(time_ns % kNsPerS)};
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr) == EINTR) {
  }
}

}  // namespace kerf::agent
