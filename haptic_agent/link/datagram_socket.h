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

/// The UDP lane of one connection, under the seals that the server has offered for it. Lives in the
/// link's thread. A lane that cannot be opened or that does not get through is just silent: the
/// WebSocket is there.
class DatagramSocket {
 public:
  /// `counts` must outlive it.
  DatagramSocket(boost::asio::io_context& io, const boost::asio::ip::address& server,
                 const datagram::Offer& offer, UdpReport& counts);

  void send(std::span<const std::byte> frame);
  /// Hands each frame that comes to `take`, until the socket is closed.
  boost::asio::awaitable<void> read_all(std::function<void(std::span<const std::byte>)> take);
  void close();

 private:
  /// False if nothing was there.
  bool receive(const std::function<void(std::span<const std::byte>)>& take);

  boost::asio::ip::udp::socket socket_;
  datagram::Sealer sealer_;
  datagram::Opener opener_;
  UdpReport& counts_;
  std::uint64_t lost_before_;
};

}  // namespace kerf::agent
