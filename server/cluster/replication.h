// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <expected>
#include <memory>
#include <string>
#include <vector>

#include "server/platform/clock.h"
#include "server/session/session_registry.h"

namespace kerf {

struct ReplicationOptions {
  std::string url;   ///< of NATS; empty: no copies
  int replicas = 1;  ///< servers of the NATS cluster that keep each stream: 1 to 5
};

/// Copies the journals of all open sessions to NATS, each on a thread of its own.
class Replication {
 public:
  /// The registry must outlive it. The error is one sentence: a bad URL, or a program without
  /// libnats. A server that is away is not an error.
  static std::expected<std::unique_ptr<Replication>, std::string> start(
      const ReplicationOptions& options, SessionRegistry& registry);
  ~Replication();

  /// Stops following the registry. Call before its sessions are closed, so that finish() can copy
  /// their last commits.
  void hold();
  /// Copies everything committed so far and ends, waiting for NATS until `end` at most. Returns the
  /// sessions whose copies are incomplete.
  std::vector<std::string> finish(Clock::time_point end);

 private:
  struct Impl;
  explicit Replication(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace kerf
