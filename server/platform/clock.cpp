// SPDX-License-Identifier: Apache-2.0
#include "server/platform/clock.h"

#include <ctime>

namespace kerf {
namespace {

// It cannot fail: the clock exists and the address is valid.
std::chrono::nanoseconds read(clockid_t clock) noexcept {
  std::timespec now{};
  clock_gettime(clock, &now);
  return std::chrono::seconds(now.tv_sec) + std::chrono::nanoseconds(now.tv_nsec);
}

double seconds(std::chrono::nanoseconds time) noexcept {
  return std::chrono::duration<double>(time).count();
}

}  // namespace

Clock::time_point Clock::now() noexcept { return time_point(read(CLOCK_MONOTONIC)); }

std::chrono::system_clock::time_point Clock::wall() noexcept {
  using Wall = std::chrono::system_clock::time_point;
  return Wall(std::chrono::duration_cast<Wall::duration>(read(CLOCK_REALTIME)));
}

std::int64_t Clock::wall_ms() noexcept {
  return std::chrono::floor<std::chrono::milliseconds>(read(CLOCK_REALTIME)).count();
}

std::int64_t Clock::wall_s() noexcept {
  return std::chrono::floor<std::chrono::seconds>(read(CLOCK_REALTIME)).count();
}

double Clock::thread_cpu_s() noexcept { return seconds(read(CLOCK_THREAD_CPUTIME_ID)); }

double Clock::process_cpu_s() noexcept { return seconds(read(CLOCK_PROCESS_CPUTIME_ID)); }

#ifdef CLOCK_BOOTTIME  // not on WASI, whose programs (web/wasm) have no journal that another server
                       // continues
std::int64_t Clock::boot_ns() noexcept { return read(CLOCK_BOOTTIME).count(); }
#endif

}  // namespace kerf
