// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

#include "kernel/cut/workers.h"

namespace kerf {

/// Thread pool for the kernel's jobs. The caller of run() processes jobs too, so it never waits for
/// a thread to wake up. Several callers may share a pool: while it serves one of them, run() of the
/// others executes its jobs serially. If a caller had to wait for a pool thread that had begun a
/// job but lost its core, the next runs are serial too.
class ThreadPool final : public Workers {
 public:
  /// `threads`: number of threads including the caller's, >= 1.
  explicit ThreadPool(int threads);
  ThreadPool(const ThreadPool&) = delete;
  ThreadPool& operator=(const ThreadPool&) = delete;
  ~ThreadPool() override;

  int count() const override { return static_cast<int>(helpers_.size()) + 1; }
  void run(int jobs, const std::function<void(int)>& job) override;

 private:
  void help();
  void work();
  void wait_for_helpers();
  void divide(int jobs, const std::function<void(int)>& job);

  std::mutex caller_;    ///< held by the caller being served; protects the next two
  int serial_runs_ = 0;  ///< remaining runs to execute serially
  int penalty_ = 0;      ///< number of serial runs after the latest delay
  std::mutex mutex_;     ///< protects the members below, except the atomics
  std::condition_variable called_, done_;
  const std::function<void(int)>* job_ = nullptr;
  int jobs_ = 0, next_ = 0;
  int failed_job_ = 0;
  std::exception_ptr failure_;  ///< exception of the failed job with the lowest number
  bool stopping_ = false;
  std::atomic<std::uint32_t> calls_ = 0;  ///< number of runs started
  std::atomic<int> working_ = 0;          ///< jobs in progress

  std::vector<std::thread> helpers_;
};

/// Returns the number of CPUs that this process may use (its affinity mask), >= 1.
int usable_threads();

}  // namespace kerf
