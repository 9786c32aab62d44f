// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <ctime>

namespace kerf {

/// ns since the machine was started, the time that it slept included. Nobody sets this clock.
inline std::int64_t boot_time_ns() {
  timespec now{};
  clock_gettime(CLOCK_BOOTTIME, &now);
  return std::int64_t{now.tv_sec} * 1'000'000'000 + now.tv_nsec;
}

/// Until when a process may add records to a journal that another machine may continue after that
/// time. It ends by itself: a process that was stopped, or cannot reach anybody, learns of it from
/// its own clock. Thread-safe.
class WriteFence {
 public:
  /// Moves the end to `ns` of boot_time_ns(); never back.
  void extend(std::int64_t ns) {
    std::int64_t end = end_ns_.load();
    while (end < ns && !end_ns_.compare_exchange_weak(end, ns)) {
    }
  }
  /// For good: another process has the journal.
  void end() { ended_.store(true); }
  bool is_open() const { return !ended_.load() && boot_time_ns() < end_ns_.load(); }

 private:
  std::atomic<std::int64_t> end_ns_ = 0;
  std::atomic<bool> ended_ = false;
};

}  // namespace kerf
