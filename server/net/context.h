// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/net/server.h"

namespace kerf::net {

class Api;
class HubDirectory;
class Lane;
class Metrics;
class UdpPort;

/// What a connection needs of the server; outlives every connection.
struct Context {
  const ServerOptions& options;
  SessionRegistry& registry;
  Metrics& metrics;
  Api& api;
  HubDirectory& hubs;
  Lane& viewers;  ///< HTTP and viewers' sockets: one thread
  Lane& meshing;  ///< short background work: meshing for viewers, state hashes
  Lane& control;  ///< HTTP requests that are answered at once
  Lane& workers;  ///< HTTP requests that may take long: downloads, uploads
  UdpPort& udp;   ///< agents that ask for the UDP lane
};

}  // namespace kerf::net
