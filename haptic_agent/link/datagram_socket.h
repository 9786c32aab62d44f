// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <boost/asio/awaitable.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/udp.hpp>
#include <functional>
#include <span>

#include "haptic_agent/link/link_report.h"
#include "server/datagram/cipher.h"

namespace kerf::agent {

/// UDP socket of one connection, encrypted with the keys that the server offered. Used on the link
/// thread only. If it cannot be opened or its datagrams are lost, it does nothing, and the
/// WebSocket carries all frames.
class DatagramSocket {
 public:
  /// `counts` must outlive the socket.
  DatagramSocket(boost::asio::io_context& io, const boost::asio::ip::address& server,
                 const datagram::Offer& offer, UdpReport& counts);

  void send(std::span<const std::byte> frame);
  /// Calls `take` with each frame that arrives, until the socket is closed.
  boost::asio::awaitable<void> read_all(std::function<void(std::span<const std::byte>)> take);
  void close();

 private:
  /// Returns false if no datagram was waiting.
  bool receive(const std::function<void(std::span<const std::byte>)>& take);

  boost::asio::ip::udp::socket socket_;
  datagram::Sealer sealer_;
  datagram::Opener opener_;
  UdpReport& counts_;
  std::uint64_t lost_before_;
};

}  // namespace kerf::agent
