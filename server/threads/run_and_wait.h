// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <exception>
#include <future>
#include <type_traits>
#include <utility>

#include "server/threads/executor.h"

namespace kerf {

/// Runs `work()` on the executor, blocks until it is done and returns its result, or throws its
/// exception. Calling it on a thread of the executor itself would deadlock. The promise belongs to
/// the thread that fulfills it, because the waiting thread could destroy it before set_value()
/// returns.
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
