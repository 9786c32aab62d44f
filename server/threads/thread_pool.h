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

/// Threads that help whoever calls run(): the caller works too, so nobody waits for a thread to
/// wake up. Any number of callers may share one: who finds it at work for another does his jobs
/// alone. Where the cores are busy with something else, and callers wait for a thread that has
/// begun a job and gets no core, the next runs are done alone too.
class ThreadPool final : public Workers {
 public:
  /// `threads` >= 1, the caller's among them.
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

  std::mutex caller_;  ///< held by the one whose jobs are being done; of the next two
  int alone_ = 0;      ///< runs yet to be done without help
  int distrust_ = 0;   ///< how many there were after the last time that help held a caller up
  std::mutex mutex_;   ///< of what follows, but for the atomics
  std::condition_variable called_, done_;
  const std::function<void(int)>* job_ = nullptr;
  int jobs_ = 0, next_ = 0;
  int failed_job_ = 0;
  std::exception_ptr failure_;  ///< what the failed job of the least number threw
  bool ends_ = false;
  std::atomic<std::uint32_t> calls_ = 0;  ///< grows with each run
  std::atomic<int> working_ = 0;          ///< jobs that a thread is at

  std::vector<std::thread> helpers_;
};

/// Threads that can run at the same time on the CPUs that this process may use, >= 1.
int usable_threads();

}  // namespace kerf
