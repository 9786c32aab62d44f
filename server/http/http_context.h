// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/http/open_connections.h"
#include "server/session/session_registry.h"
#include "server/socket/peer_context.h"

namespace kerf::net {

class Api;
class TlsCertificate;
struct HttpOptions;

/// The parts of the server that an HTTP connection uses; outlives every connection.
struct HttpContext {
  const HttpOptions& options;
  SessionRegistry& registry;
  Metrics& metrics;
  Api& api;
  IoThreads& immediate;   ///< requests that wait for nothing
  IoThreads& control;     ///< requests that wait for a turn of a session's thread
  IoThreads& workers;     ///< requests that may take long: uploads, new sessions
  IoThreads& exports;     ///< downloads
  PeerContext& peers;     ///< for connections that become WebSockets
  OpenConnections& open;  ///< viewers' thread only
  const TlsCertificate* certificate = nullptr;  ///< null: without TLS
};

}  // namespace kerf::net
