// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <mutex>
#include <utility>

#include "tests/server/manual_executor.h"

namespace kerf::test {

/// A ManualExecutor to which other threads may post.
class SharedExecutor final : public Executor {
 public:
  void post(Work work) override {
    const std::lock_guard lock(mutex_);
    queue_.post(std::move(work));
  }
  void post_after(std::chrono::microseconds delay, Work work) override {
    const std::lock_guard lock(mutex_);
    queue_.post_after(delay, std::move(work));
  }
  /// Runs all posted work and, with `delayed`, all delayed work.
  void run(bool delayed = false) {
    while (run_one(std::exchange(delayed, false))) {
    }
  }
  /// Runs the oldest posted work. Returns false if there is none. With `delayed`, posts delayed
  /// work first.
  bool run_one(bool delayed = false) {
    Work next;
    {
      const std::lock_guard lock(mutex_);
      if (delayed) queue_.release_delayed();
      auto work = queue_.take_one();
      if (!work) return false;
      next = *std::move(work);
    }
    next();
    return true;
  }
  std::size_t waiting() {
    const std::lock_guard lock(mutex_);
    return queue_.waiting();
  }

 private:
  std::mutex mutex_;
  ManualExecutor queue_;
};

}  // namespace kerf::test
