// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/http/open_connections.h"
#include "server/http/routes.h"
#include "server/session/session_registry.h"
#include "server/socket/peer_context.h"
#include "server/threads/fair_queue.h"

namespace kerf::net {

class TlsCertificate;
struct HttpOptions;

/// The parts of the server that HTTP connections use. Outlives every connection.
struct HttpContext {
  const HttpOptions& options;
  SessionRegistry& registry;
  Metrics& metrics;
  Api& api;
  IoThreads& immediate;                                        ///< requests that never block
  FairQueue &control, &history, &workers, &readers, &exports;  ///< queues by Runs
  PeerContext& peers;                           ///< for connections that become WebSockets
  OpenConnections& open;                        ///< viewers' thread only
  const TlsCertificate* certificate = nullptr;  ///< null without TLS

  /// The queue of requests that may block; null for the rest.
  FairQueue* turns_of(Runs runs) const {
    switch (runs) {
      case Runs::kAtOnce:
        return nullptr;
      case Runs::kSession:
        return &control;
      case Runs::kHistory:
        return &history;
      case Runs::kWork:
        return &workers;
      case Runs::kRead:
        return &readers;
      case Runs::kExport:
        return &exports;
    }
    return nullptr;
  }
};

}  // namespace kerf::net
