// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <expected>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <unordered_map>

#include "server/udp/udp_peer.h"

namespace kerf::net {

/// The UDP socket of all agents and the thread that reads it. The thread looks up the connection of
/// a datagram, decrypts it and posts its frame to the executor of the agent's session. A datagram
/// that is not authentic is dropped and counted, and never answered.
class UdpPort {
 public:
  explicit UdpPort(Metrics& metrics) : metrics_(metrics) {}
  ~UdpPort();
  UdpPort(const UdpPort&) = delete;
  UdpPort& operator=(const UdpPort&) = delete;

  /// Binds the socket and starts the thread; may be called once. Port 0 lets the system choose the
  /// port. The error is one sentence.
  std::expected<void, std::string> listen(const std::string& address, std::uint16_t port);
  /// Returns the bound port; 0 if the port is not open.
  std::uint16_t port() const noexcept { return port_; }

  /// Creates a connection with new keys; returns null if the port is not open or no keys could be
  /// generated. `take` is called on `executor`, which must exist until close() returns.
  std::shared_ptr<UdpPeer> open(Executor& executor, UdpPeer::Take take);
  /// Removes a connection: afterwards nothing is posted to its executor and its keys are invalid.
  void close(const UdpPeer& peer);

 private:
  void run();
  bool receive_one();

  Metrics& metrics_;
  std::shared_ptr<UdpSocket> socket_;
  std::uint16_t port_ = 0;
  int stop_ = -1;
  std::thread thread_;
  /// Protects `peers_`. Held while a datagram is processed, so that close() returns only when the
  /// thread no longer uses the peer.
  std::mutex mutex_;
  std::unordered_map<std::uint32_t, std::shared_ptr<UdpPeer>> peers_;
};

}  // namespace kerf::net
