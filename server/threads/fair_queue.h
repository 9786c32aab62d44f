// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <stop_token>
#include <string>

#include "server/threads/executor.h"

namespace kerf {

/// Runs the jobs of clients on an executor, in turns: the next job is that of the waiting client
/// with the fewest running jobs and, among these, the longest wait for a turn. A client without a
/// running job waits for the running jobs, and for at most one more of each other client, however
/// many they send. One client has at most `parallel` - 1 running jobs, or 1, so that another one
/// finds a thread. Thread-safe.
class FairQueue {
 public:
  struct Job {
    std::string client;  ///< takes this client's turn
    Work work;
    /// Called instead of `work` once a stop is requested before it has begun, by the requesting
    /// thread, or in post(). Must be quick.
    Work dropped;
    std::stop_token stop = {};
  };

  /// At most `parallel` >= 1 jobs run at the same time. The executor must outlive the queue and the
  /// running jobs.
  FairQueue(Executor& executor, int parallel);
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
