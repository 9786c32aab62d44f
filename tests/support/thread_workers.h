// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <functional>
#include <thread>
#include <vector>

#include "kernel/cut/workers.h"

namespace kerf::test {

/// Runs jobs on new threads, from the last job to the first. Results that depend on the thread or
/// the order of a job differ from those of one thread.
class ThreadWorkers final : public Workers {
 public:
  explicit ThreadWorkers(int count) : count_(count) {}
  int count() const override { return count_; }
  void run(int jobs, const std::function<void(int)>& job) override {
    runs_ += jobs > 1 ? 1 : 0;
    std::atomic<int> left = jobs;
    const auto work = [&] {
      for (int i = --left; i >= 0; i = --left) job(i);
    };
    std::vector<std::thread> threads;
    for (int t = 1; t < count_; ++t) threads.emplace_back(work);
    work();
    for (std::thread& thread : threads) thread.join();
  }
  /// Number of runs with more than one job.
  int runs() const { return runs_; }

 private:
  int count_, runs_ = 0;
};

}  // namespace kerf::test
