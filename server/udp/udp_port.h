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

/// The UDP socket that all agents share, and the thread that reads it. The thread looks up the
/// connection, decrypts the datagram and posts the frame to the agent's executor. Datagrams that
/// are not authentic are dropped and counted, never answered.
class UdpPort {
 public:
  explicit UdpPort(Metrics& metrics) : metrics_(metrics) {}
  ~UdpPort();
  UdpPort(const UdpPort&) = delete;
  UdpPort& operator=(const UdpPort&) = delete;

  /// Starts listening. Call once. Port 0: the system picks one. The error is one sentence.
  std::expected<void, std::string> listen(const std::string& address, std::uint16_t port);
  /// 0 if it is not listening.
  std::uint16_t port() const noexcept { return port_; }

  /// Creates a connection with its own keys, or null if UDP is off. `take` is called on `executor`,
  /// which must exist until the peer is closed.
  std::shared_ptr<UdpPeer> open(Executor& executor, UdpPeer::Take take);
  /// Stops posting to the peer's executor and invalidates its keys.
  void close(const UdpPeer& peer);

 private:
  void run();
  bool receive_one();

  Metrics& metrics_;
  std::shared_ptr<UdpSocket> socket_;
  std::uint16_t port_ = 0;
  int stop_ = -1;
  std::thread thread_;
  /// Held while a datagram is decrypted, so that close() waits for a datagram in progress.
  std::mutex mutex_;
  std::unordered_map<std::uint32_t, std::shared_ptr<UdpPeer>> peers_;
};

}  // namespace kerf::net
