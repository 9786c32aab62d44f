// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <future>
#include <type_traits>
#include <utility>

#include "server/threads/executor.h"

namespace kerf {

/// Runs `work()` on the executor, blocks until it is done and returns its result. Calling it on a
/// thread of the executor itself would deadlock. The promise belongs to the thread that keeps it:
/// who waits for one may destroy it while set_value() has not returned.
template <typename Work>
std::invoke_result_t<Work&> run_and_wait(Executor& executor, Work work) {
  std::promise<std::invoke_result_t<Work&>> promise;
  auto result = promise.get_future();
  executor.post([work = std::move(work), promise = std::move(promise)]() mutable {
    promise.set_value(work());
  });
  return result.get();
}

}  // namespace kerf
