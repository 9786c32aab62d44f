// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <mutex>
#include <span>

#include "server/datagram/cipher.h"
#include "server/session/rate_limit.h"
#include "server/threads/executor.h"
#include "server/udp/udp_address.h"

namespace kerf::net {

class Metrics;

/// The descriptor of a socket, closed when the last of those that send over it has gone.
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

/// One agent on the UDP lane, as long as its WebSocket lasts.
class UdpPeer : public std::enable_shared_from_this<UdpPeer> {
 public:
  using Clock = std::chrono::steady_clock;
  /// Takes a frame of the agent, on the agent's lane.
  using Take = std::function<void(std::span<const std::byte> frame, Clock::time_point arrived)>;

  /// Datagrams that wait for the agent's lane; more are dropped, as a network would.
  static constexpr int kWaitingMax = 64;
  /// Three times what an agent at 1 kHz sends: whoever sends more keeps its lane from others.
  static constexpr double kDatagramsPerS = 3000;
  static constexpr double kDatagramsBurst = 1000;

  UdpPeer(std::shared_ptr<UdpSocket> socket, const datagram::Offer& offer, Executor& lane,
          Take take, Metrics& metrics);

  const datagram::Offer& offer() const noexcept { return offer_; }

  /// A datagram that names this connection. Only the port's thread, and only while the agent's
  /// lane is there.
  void receive(std::span<const std::byte> datagram, const UdpAddress& from,
               Clock::time_point arrived);

  /// Sends a frame to where the agent's newest datagram came from. Only the agent's lane.
  void send(std::span<const std::byte> frame);

 private:
  std::shared_ptr<UdpSocket> socket_;
  datagram::Offer offer_;
  Executor& lane_;
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
