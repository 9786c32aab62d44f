// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>

#include "server/cluster/nats_connection.h"
#include "server/session/session_registry.h"

namespace kerf {

/// Publishes the displayed state of this server's sessions to the servers that follow them, 25
/// times a second, and counts the viewers there. A session without followers costs nothing.
class LiveStates {
 public:
  /// The first two must outlive it. `node` is this server.
  LiveStates(NatsConnection& nats, SessionRegistry& registry, std::string node);
  ~LiveStates();
  LiveStates(const LiveStates&) = delete;
  LiveStates& operator=(const LiveStates&) = delete;

 private:
  struct Follower {
    std::size_t viewers = 0;
    std::int64_t since_ns = 0;
  };
  using Followers = std::map<std::string, Follower>;  ///< by server
  void run(const std::stop_token& stop);
  void hear();
  void state(const std::string& session, const Followers& followers);
  std::map<std::string, Followers> fresh();

  NatsConnection& nats_;
  SessionRegistry& registry_;
  const std::string node_;
  std::mutex mutex_;                           ///< guards the next
  std::map<std::string, Followers> followed_;  ///< by session
  std::optional<NatsListener> listener_;       ///< thread only
  std::jthread thread_;
};

}  // namespace kerf
