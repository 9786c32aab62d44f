// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <memory>
#include <stop_token>
#include <string>

#include "server/platform/clock.h"
#include "server/threads/executor.h"

namespace kerf {

/// Runs the jobs of clients on an executor, in turns: the next job is that of the waiting client
/// with the fewest running jobs and, among these, the longest wait for a turn. A job may take kTurn
/// of a thread. A client whose jobs took more has an excess and gives up one of its next turns for
/// each kTurn of it (deficit round robin), so waiting clients get the same time, whatever their
/// jobs cost. An excess ends when the queue is empty.
///
/// A client without a running job and without an excess waits for the running jobs, and for at most
/// one more of each other client, however many they send. One client has at most `parallel` - 1
/// running jobs, or 1, so that another one finds a thread. Thread-safe.
class FairQueue {
 public:
  static constexpr std::chrono::milliseconds kTurn{10};
  using Now = std::function<Clock::time_point()>;

  struct Job {
    std::string client;  ///< takes this client's turn
    Work work;
    /// Called instead of `work` once a stop is requested before it has begun, by the requesting
    /// thread, or in post(). Must be quick.
    Work dropped;
    std::stop_token stop = {};
  };

  /// At most `parallel` >= 1 jobs run at the same time. The executor must outlive the queue and the
  /// running jobs. `now` measures the time of jobs.
  FairQueue(Executor& executor, int parallel, Now now = &Clock::now);
  /// Destroys waiting jobs without a call. Running jobs continue.
  ~FairQueue();
  FairQueue(const FairQueue&) = delete;
  FairQueue& operator=(const FairQueue&) = delete;

  void post(Job job);
  /// Number of jobs that have not begun.
  std::size_t waiting() const;

 private:
  struct State;
  std::shared_ptr<State> state_;
};

}  // namespace kerf
