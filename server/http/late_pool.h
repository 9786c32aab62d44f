// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <memory>
#include <mutex>
#include <thread>

#include "server/threads/thread_pool.h"

namespace kerf::net {

/// A thread for each core, created on first use. They inherit the niceness of the caller that uses
/// them first. Thread-safe.
class LatePool {
 public:
  ThreadPool& get() {
    std::call_once(made_, [this] {
      pool_ = std::make_unique<ThreadPool>(
          std::max(1, static_cast<int>(std::thread::hardware_concurrency())));
    });
    return *pool_;
  }

 private:
  std::once_flag made_;
  std::unique_ptr<ThreadPool> pool_;
};

}  // namespace kerf::net
