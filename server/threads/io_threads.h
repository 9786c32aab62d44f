// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <boost/asio/io_context.hpp>
#include <memory>
#include <string>

#include "server/threads/executor.h"

namespace kerf {

/// An io_context and the threads that run it. Each session has one with a single thread, on which
/// both its executor and its agents' sockets run, so that a motion is read, cut and answered
/// without a change of thread. Viewers, HTTP and background work have their own, at a lower
/// priority, and never share a thread with an agent.
class IoThreads final : public Executor {
 public:
  /// `niceness`: 0 for agents, higher for work that can wait. A thread inherits the niceness of its
  /// creator and cannot lower it, so the threads of agents must be created by a thread of niceness
  /// 0 (see create_nested).
  IoThreads(const std::string& name, int threads, int niceness);
  /// Creates IoThreads on a thread of this object, whose niceness they inherit, and waits for them.
  /// Must not be called on that thread.
  std::shared_ptr<IoThreads> create_nested(const std::string& name, int threads, int niceness);
  /// Stops and joins the threads. When called on one of them, that thread ends by itself
  /// afterwards.
  ~IoThreads() override;
  IoThreads(const IoThreads&) = delete;
  IoThreads& operator=(const IoThreads&) = delete;

  void post(Work work) override;
  void post_after(std::chrono::microseconds delay, Work work) override;
  boost::asio::io_context& context();

 private:
  struct State;
  std::shared_ptr<State> state_;
};

}  // namespace kerf
