// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <exception>
#include <future>
#include <type_traits>
#include <utility>

#include "server/threads/executor.h"

namespace kerf {

/// Runs `work()` on the executor, blocks until it is done and returns its result, or throws what it
/// throws. Calling it on a thread of the executor itself would deadlock. The promise belongs to the
/// thread that keeps it: who waits for one may destroy it while set_value() has not returned.
template <typename Work>
std::invoke_result_t<Work&> run_and_wait(Executor& executor, Work work) {
  std::promise<std::invoke_result_t<Work&>> promise;
  auto result = promise.get_future();
  executor.post([work = std::move(work), promise = std::move(promise)]() mutable {
    try {
      promise.set_value(work());
    } catch (...) {
      promise.set_exception(std::current_exception());
    }
  });
  return result.get();
}

}  // namespace kerf
