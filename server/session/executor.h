// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <functional>

namespace kerf {

/// Work to do once; may own what it needs.
using Work = std::move_only_function<void()>;

/// Somewhere to run work. A session's executor runs one piece at a time, in the order of posting; a
/// worker pool runs several. The session does not know how it is done: net supplies it, tests may
/// step through it by hand.
class Executor {
 public:
  virtual ~Executor() = default;
  virtual void post(Work work) = 0;
  virtual void post_after(std::chrono::microseconds delay, Work work) = 0;
};

}  // namespace kerf
