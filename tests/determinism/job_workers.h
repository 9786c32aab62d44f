// SPDX-License-Identifier: Apache-2.0
#pragma once

#ifdef __wasm__

#include <functional>

#include "kernel/cut/workers.h"

namespace kerf::test {

/// WebAssembly is built without threads.
class JobWorkers final : public Workers {
 public:
  explicit JobWorkers(int) {}
  int count() const override { return 1; }
  void run(int jobs, const std::function<void(int)>& job) override { serial_.run(jobs, job); }
  int runs() const { return 0; }

 private:
  SerialWorkers serial_;
};

}  // namespace kerf::test

#else

#include "tests/support/thread_workers.h"

namespace kerf::test {

using JobWorkers = ThreadWorkers;

}  // namespace kerf::test

#endif
