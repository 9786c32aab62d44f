// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <functional>

namespace kerf {

/// Work to do once; may own what it needs.
using Work = std::move_only_function<void()>;

/// Runs work. A session's executor runs one piece at a time, in the order of posting; a worker pool
/// runs several at once. The server implements it with threads (IoThreads); tests step through it
/// by hand.
class Executor {
 public:
  virtual ~Executor() = default;
  virtual void post(Work work) = 0;
  virtual void post_after(std::chrono::microseconds delay, Work work) = 0;
};

}  // namespace kerf
