// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

namespace kerf {

/// Runs independent jobs in parallel. The kernel has no threads of its own; its caller provides
/// them through this interface. Results do not depend on the number of threads: each job writes to
/// its own output, and outputs are combined in the order of the jobs' numbers.
class Workers {
 public:
  virtual ~Workers() = default;
  /// Returns the number of jobs that can run at the same time, >= 1.
  virtual int count() const = 0;
  /// Calls job(0) … job(jobs − 1), each once, on any threads and in any order, and returns when all
  /// have returned. An exception of a job is rethrown after all running jobs have ended; jobs that
  /// have not begun may then be skipped.
  virtual void run(int jobs, const std::function<void(int)>& job) = 0;
};

/// Runs jobs one after the other on the calling thread.
class SerialWorkers final : public Workers {
 public:
  int count() const override { return 1; }
  void run(int jobs, const std::function<void(int)>& job) override {
    for (int i = 0; i < jobs; ++i) job(i);
  }
};

}  // namespace kerf
