// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <boost/asio/as_tuple.hpp>
#include <boost/asio/awaitable.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <expected>
#include <memory>
#include <optional>

#include "haptic_agent/link/datagram_socket.h"
#include "haptic_agent/link/server_link.h"
#include "server/websocket/web_socket.h"

namespace kerf::agent {

/// Completion token: errors are returned as values, not thrown.
inline constexpr auto kAwait = boost::asio::as_tuple(boost::asio::use_awaitable);

/// One connection, shared by its reading and its writing coroutine.
struct Connection {
  explicit Connection(boost::asio::io_context& io) : tcp(io), reader_ended(io) {
    reader_ended.expires_at(boost::asio::steady_timer::time_point::max());
  }
  /// Ends the connection at once, at any stage.
  void cut();

  /// Used until it is connected. Then it moves to `stream` and, under TLS, to `socket`.
  boost::asio::ip::tcp::socket tcp;
  std::optional<net::ByteStream> stream;
  std::unique_ptr<net::WebSocket> socket;
  /// Cancelled when the reader has ended, to wake the coroutine that waits for it.
  boost::asio::steady_timer reader_ended;
  bool reading = false;
  /// Null without a UDP transport.
  std::unique_ptr<DatagramSocket> udp;
  std::optional<Loss> loss;
};

/// Connects to the server, opens the session's WebSocket, sends hello and waits for the welcome.
/// Both references must outlive the wait.
boost::asio::awaitable<std::expected<Welcome, Loss>> join(Connection& connection,
                                                          const LinkSettings& settings);

}  // namespace kerf::agent
