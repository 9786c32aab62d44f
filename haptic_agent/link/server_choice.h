// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "haptic_agent/link/server_url.h"

namespace kerf::agent {

/// The servers that may continue a session, and the next one to try.
class ServerChoice {
 public:
  /// Call when the server `at`, which has accepted the agent, names other servers.
  void welcomed(const ServerUrl& at, const std::vector<std::string>& others) {
    servers_ = {at};
    at_ = 0;
    for (const std::string& other : others) {
      if (const auto server = follow_redirect(at, other)) servers_.push_back(*server);
    }
  }
  /// Whether there is more than one server.
  bool has_others() const { return servers_.size() > 1; }
  /// Call when the last server was unreachable or did not accept the agent: moves `server` to the
  /// next one. Returns true if every server has been tried since the last time.
  bool turn(ServerUrl& server) {
    if (!has_others()) return true;
    at_ = (at_ + 1) % servers_.size();
    server = servers_[at_];
    return at_ == 0;
  }

 private:
  std::vector<ServerUrl> servers_;
  std::size_t at_ = 0;
};

}  // namespace kerf::agent
