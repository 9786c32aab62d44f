// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>

#include "server/platform/clock.h"

namespace kerf {

/// Until when a process may add records to a journal that another machine may continue after that
/// time. It ends by itself: a process that was stopped, or cannot reach anybody, learns of it from
/// its own clock. Thread-safe.
class WriteFence {
 public:
  /// Moves the end to `ns` of Clock::boot_ns(); never back.
  void extend(std::int64_t ns) {
    std::int64_t end = end_ns_.load();
    while (end < ns && !end_ns_.compare_exchange_weak(end, ns)) {
    }
  }
  /// For good: another process has the journal.
  void end() { ended_.store(true); }
  bool is_open() const { return !ended_.load() && Clock::boot_ns() < end_ns_.load(); }

 private:
  std::atomic<std::int64_t> end_ns_ = 0;
  std::atomic<bool> ended_ = false;
};

}  // namespace kerf
