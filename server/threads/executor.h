// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <functional>

namespace kerf {

/// A function to call once. It may own move-only state.
using Work = std::move_only_function<void()>;

/// Interface of a thread or thread pool that runs posted work. The executor of a session runs one
/// piece of work at a time, in the order of posting. A worker pool runs several at a time.
/// IoThreads implements it. Tests use ManualExecutor.
class Executor {
 public:
  virtual ~Executor() = default;
  virtual void post(Work work) = 0;
  virtual void post_after(std::chrono::microseconds delay, Work work) = 0;
};

}  // namespace kerf
