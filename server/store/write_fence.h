// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>

#include "server/platform/clock.h"

namespace kerf {

/// The time until which a process may add records to a journal that another machine may continue
/// afterwards. It expires by the local clock, so it also stops a process that was suspended or is
/// isolated. Thread-safe.
class WriteFence {
 public:
  /// Extends the time to `ns` of Clock::boot_ns(). Never shortens it.
  void extend(std::int64_t ns) {
    std::int64_t end = end_ns_.load();
    while (end < ns && !end_ns_.compare_exchange_weak(end, ns)) {
    }
  }
  /// Closes the fence for good: another process has the journal.
  void end() { ended_.store(true); }
  bool is_open() const { return !ended_.load() && Clock::boot_ns() < end_ns_.load(); }

 private:
  std::atomic<std::int64_t> end_ns_ = 0;
  std::atomic<bool> ended_ = false;
};

}  // namespace kerf
