// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <mutex>
#include <span>

#include "server/datagram/cipher.h"
#include "server/platform/clock.h"
#include "server/session/rate_limit.h"
#include "server/threads/executor.h"
#include "server/udp/udp_address.h"

namespace kerf::net {

class Metrics;

/// Owns the descriptor of a socket. Peers share it, and the last owner closes it.
class UdpSocket {
 public:
  explicit UdpSocket(int descriptor) noexcept : descriptor_(descriptor) {}
  ~UdpSocket();
  UdpSocket(const UdpSocket&) = delete;
  UdpSocket& operator=(const UdpSocket&) = delete;
  int descriptor() const noexcept { return descriptor_; }

 private:
  int descriptor_;
};

/// The UDP connection of one agent. It lasts as long as its WebSocket.
class UdpPeer : public std::enable_shared_from_this<UdpPeer> {
 public:
  /// Receives a frame of the agent, on the agent's executor.
  using Take = std::function<void(std::span<const std::byte> frame, Clock::time_point arrived)>;

  /// Datagrams waiting for the agent's executor. More are dropped.
  static constexpr int kWaitingMax = 64;
  /// Three times the rate of an agent at 1 kHz. More would delay the other agents of the session.
  static constexpr double kDatagramsPerS = 3000;
  static constexpr double kDatagramsBurst = 1000;

  UdpPeer(std::shared_ptr<UdpSocket> socket, const datagram::Offer& offer, Executor& executor,
          Take take, Metrics& metrics);

  const datagram::Offer& offer() const noexcept { return offer_; }

  /// Handles a datagram with this connection number. Called by the port's thread, and only while
  /// the agent's executor exists.
  void receive(std::span<const std::byte> datagram, const UdpAddress& from,
               Clock::time_point arrived);

  /// Sends a frame to the source address of the agent's newest datagram. Agent's executor only.
  void send(std::span<const std::byte> frame);

 private:
  std::shared_ptr<UdpSocket> socket_;
  datagram::Offer offer_;
  Executor& executor_;
  Take take_;
  Metrics& metrics_;
  datagram::Opener opener_;
  datagram::Sealer sealer_;
  RateLimit rate_{kDatagramsPerS, kDatagramsBurst};
  std::atomic<int> waiting_{0};
  std::mutex address_mutex_;
  UdpAddress address_;
};

}  // namespace kerf::net
