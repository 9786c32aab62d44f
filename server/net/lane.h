// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <boost/asio/io_context.hpp>
#include <cstddef>
#include <memory>
#include <string>

#include "server/session/executor.h"

namespace kerf::net {

/// One io_context and the threads that run it. Each session has a lane of its own with one thread:
/// its agents' sockets and its executor live there together, so that a motion is read, cut and
/// answered without a change of thread. Viewers, HTTP and background work have lanes too, at a
/// lower priority, and never share a thread with an agent.
class Lane final : public Executor {
 public:
  /// `niceness` 0 for agents, higher for those who can wait. A thread takes over the niceness of
  /// the one that makes it and cannot lower it: whoever waits longer must not make a lane for
  /// agents.
  Lane(const std::string& name, int threads, int niceness);
  /// Makes a lane on this one's thread and waits for it; not to be called there.
  std::shared_ptr<Lane> make(const std::string& name, int threads, int niceness);
  /// Stops the threads. May happen on one of them: then that thread ends by itself afterwards.
  ~Lane() override;
  Lane(const Lane&) = delete;
  Lane& operator=(const Lane&) = delete;

  void post(Work work) override;
  void post_after(std::chrono::microseconds delay, Work work) override;
  boost::asio::io_context& context();

 private:
  struct State;
  std::shared_ptr<State> state_;
};

}  // namespace kerf::net
