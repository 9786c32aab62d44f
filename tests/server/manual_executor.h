// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <optional>
#include <utility>

#include "server/threads/executor.h"

namespace kerf::test {

/// An executor that runs work only when a test calls it, in the order of posting. Delays are
/// recorded but not waited for.
class ManualExecutor final : public Executor {
 public:
  void post(Work work) override { queue_.push_back(std::move(work)); }
  void post_after(std::chrono::microseconds delay, Work work) override {
    delayed_.push_back(std::move(work));
    last_delay = delay;
  }
  /// Runs the posted work, including work that it posts, but no delayed work.
  void run() {
    while (!queue_.empty()) run_one();
  }
  /// Runs the oldest posted work. Returns false if there is none.
  bool run_one() {
    if (queue_.empty()) return false;
    Work work = std::move(queue_.front());
    queue_.pop_front();
    work();
    return true;
  }
  /// Runs the delayed work, then run().
  void run_delayed() {
    for (Work& work : std::exchange(delayed_, {})) work();
    run();
  }
  /// Takes the oldest posted work, to be run by the caller.
  std::optional<Work> take_one() {
    if (queue_.empty()) return std::nullopt;
    Work work = std::move(queue_.front());
    queue_.pop_front();
    return work;
  }
  /// Posts the delayed work.
  void release_delayed() {
    for (Work& work : std::exchange(delayed_, {})) queue_.push_back(std::move(work));
  }
  std::size_t waiting() const { return queue_.size(); }

  std::chrono::microseconds last_delay{0};

 private:
  std::deque<Work> queue_;
  std::deque<Work> delayed_;
};

}  // namespace kerf::test
