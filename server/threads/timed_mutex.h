// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>

#include "server/platform/clock.h"

namespace kerf {

/// std::timed_mutex, built from a mutex and a condition: ThreadSanitizer of GCC 12 knows their
/// waits, but not pthread_mutex_clocklock, which std::timed_mutex uses. For locks that are held for
/// long and taken rarely.
class TimedMutex {
 public:
  bool try_lock() {
    const std::lock_guard guard(mutex_);
    if (is_locked_) return false;
    is_locked_ = true;
    return true;
  }
  template <class Duration>
  bool try_lock_until(const std::chrono::time_point<std::chrono::steady_clock, Duration>& until) {
    std::unique_lock guard(mutex_);
    if (!unlocked_.wait_until(guard, until, [&] { return !is_locked_; })) return false;
    is_locked_ = true;
    return true;
  }
  template <class Rep, class Period>
  bool try_lock_for(const std::chrono::duration<Rep, Period>& patience) {
    return try_lock_until(Clock::now() + patience);
  }
  void unlock() {
    const std::lock_guard guard(mutex_);
    is_locked_ = false;
    unlocked_.notify_one();
  }

 private:
  std::mutex mutex_;
  std::condition_variable unlocked_;
  bool is_locked_ = false;
};

}  // namespace kerf
