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

/// The one UDP socket of all agents, and the thread that reads it: looks up the connection, opens
/// the seal, hands the frame to the agent's lane. Whatever has no true seal is dropped and counted,
/// and never answered.
class UdpPort {
 public:
  explicit UdpPort(Metrics& metrics) : metrics_(metrics) {}
  ~UdpPort();
  UdpPort(const UdpPort&) = delete;
  UdpPort& operator=(const UdpPort&) = delete;

  /// Starts to listen, once; port 0: the system picks one. The error is one sentence.
  std::expected<void, std::string> listen(const std::string& address, std::uint16_t port);
  /// 0 if it does not listen.
  std::uint16_t port() const noexcept { return port_; }

  /// A new connection with keys of its own; null where none can be offered. `take` is called on
  /// `lane`, which must stay until the peer has been closed.
  std::shared_ptr<UdpPeer> open(Executor& lane, UdpPeer::Take take);
  /// Nothing is posted to the peer's lane from now on, and its keys are worth nothing.
  void close(const UdpPeer& peer);

 private:
  void run();
  bool receive_one();

  Metrics& metrics_;
  std::shared_ptr<UdpSocket> socket_;
  std::uint16_t port_ = 0;
  int stop_ = -1;
  std::thread thread_;
  /// Held while a datagram is opened, so that a peer that was closed is not in the middle of one.
  std::mutex mutex_;
  std::unordered_map<std::uint32_t, std::shared_ptr<UdpPeer>> peers_;
};

}  // namespace kerf::net
