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

/// A pool of threads that share the jobs of run() with its caller. The caller works too, so it
/// never waits for a thread to wake up. Several callers may share a pool. A caller that finds it
/// busy does its jobs alone. After a run in which a helper that had lost its core delayed the
/// caller, the next runs are done without helpers.
class ThreadPool final : public Workers {
 public:
  /// Behavior of a thread after a run. The motions of a program follow each other faster than a
  /// thread wakes up, those of agents do not.
  enum class Idle { kSpinsBriefly, kSleeps };
  /// `threads` >= 1, including the caller's.
  explicit ThreadPool(int threads, Idle idle = Idle::kSpinsBriefly);
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

  const Idle idle_;
  std::mutex caller_;    ///< held during run(); guards the next two
  int serial_runs_ = 0;  ///< runs still to do without helpers
  int penalty_ = 0;      ///< value of serial_runs_ after the last delay
  std::mutex mutex_;     ///< guards the following members except atomics
  std::condition_variable called_, done_;
  const std::function<void(int)>* job_ = nullptr;
  int jobs_ = 0, next_ = 0;
  int failed_job_ = 0;
  std::exception_ptr failure_;  ///< thrown by the failed job with the lowest number
  bool stopping_ = false;
  std::atomic<std::uint32_t> calls_ = 0;  ///< grows with each run
  std::atomic<int> working_ = 0;          ///< jobs in progress

  std::vector<std::thread> helpers_;
};

/// Returns the number of CPUs that this process may use, >= 1.
int usable_threads();

}  // namespace kerf
