// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <exception>
#include <functional>

namespace kerf {

/// Who does jobs that do not depend on each other. The kernel has no thread of its own: whoever
/// calls it says what threads there are. Results never depend on them, for each job writes to its
/// own place and what the jobs found is put together in the order of their numbers.
class Workers {
 public:
  virtual ~Workers() = default;
  /// Jobs that can run at the same time, >= 1.
  virtual int count() const = 0;
  /// Calls job(0) … job(jobs − 1), each once, on any threads and in any order, and returns when all
  /// have returned. What a job throws is thrown here, once the others have ended.
  virtual void run(int jobs, const std::function<void(int)>& job) = 0;
};

/// The calling thread alone.
class SerialWorkers final : public Workers {
 public:
  int count() const override { return 1; }
  void run(int jobs, const std::function<void(int)>& job) override {
    std::exception_ptr failure;
    for (int i = 0; i < jobs; ++i) {
      try {
        job(i);
      } catch (...) {
        if (!failure) failure = std::current_exception();
      }
    }
    if (failure) std::rethrow_exception(failure);
  }
};

}  // namespace kerf
