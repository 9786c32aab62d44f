// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <memory>
#include <stop_token>
#include <string>
#include <thread>

#include "server/cluster/snapshot_copy.h"
#include "server/session/session_registry.h"

namespace kerf {

/// Copies the snapshots of all open sessions, one after the other, on a thread of its own. Nobody
/// waits for it, and it uses the connection for at most half of the time.
class SnapshotCopies {
 public:
  /// Both must outlive it.
  SnapshotCopies(NatsConnection& nats, int replicas, SessionRegistry& registry);
  /// Ends after the current message.
  ~SnapshotCopies();
  /// Starts no further copy. Returns at once.
  void stop() { thread_.request_stop(); }
  SnapshotCopies(const SnapshotCopies&) = delete;
  SnapshotCopies& operator=(const SnapshotCopies&) = delete;

 private:
  struct Copied {
    std::weak_ptr<Session> session;
    std::unique_ptr<SnapshotCopy> copy;
    std::string fault;  ///< as logged
  };
  void run(const std::stop_token& stop);
  /// Returns whether a message was sent.
  bool look_at(Copied& copied, const std::stop_token& stop);
  void follow_registry();

  NatsConnection& nats_;
  int replicas_;
  SessionRegistry& registry_;
  std::map<std::string, Copied> copies_;  ///< thread only
  std::jthread thread_;
};

}  // namespace kerf
