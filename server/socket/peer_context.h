// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/session/session.h"
#include "server/threads/io_threads.h"

namespace kerf::net {

class HubDirectory;
class Metrics;
class UdpPort;

/// The parts of the server that the WebSockets of agents and viewers use; outlives every
/// connection.
struct PeerContext {
  const SessionLimits& limits;
  Metrics& metrics;
  HubDirectory& hubs;
  UdpPort& udp;
  std::uint32_t viewer_budget;  ///< upper limit, bytes of mesh frames per second; 0: unlimited
  IoThreads& viewers;           ///< viewers' sockets: one thread
  IoThreads& meshing;           ///< short background work: tiles for viewers, state hashes
  IoThreads& past;              ///< blocks of viewers of the past: one thread
};

/// The thread of a session. The server creates the executor of every session as IoThreads.
inline IoThreads& threads_of(Session& session) {
  return static_cast<IoThreads&>(session.executor());
}

}  // namespace kerf::net
