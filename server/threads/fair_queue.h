// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <stop_token>
#include <string>

#include "server/threads/executor.h"

namespace kerf {

/// Runs the jobs of clients on an executor, in turns: of the clients that wait, the one with the
/// fewest running jobs is next, and of these the one that has waited longest for a turn. A client
/// without a running job waits for the jobs that run, and for at most one more of each other
/// client, however many they send. One client has at most `parallel` - 1 running jobs, or 1, so
/// that another one finds a thread. Thread-safe.
class FairQueue {
 public:
  struct Job {
    std::string client;  ///< whose turn it takes
    Work work;
    /// Called instead of `work` once a stop is requested before that has begun; by the thread that
    /// requests it, or in post(). Must be quick.
    Work dropped;
    std::stop_token stop = {};
  };

  /// At most `parallel` >= 1 jobs run at the same time. The executor must outlive the queue and
  /// the jobs that run.
  FairQueue(Executor& executor, int parallel);
  /// Jobs that wait are destroyed without a call; those that run go on.
  ~FairQueue();
  FairQueue(const FairQueue&) = delete;
  FairQueue& operator=(const FairQueue&) = delete;

  void post(Job job);
  /// Jobs that have not begun.
  std::size_t waiting() const;

 private:
  struct State;
  std::shared_ptr<State> state_;
};

}  // namespace kerf
