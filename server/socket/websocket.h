// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <boost/asio/awaitable.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/message.hpp>
#include <boost/beast/websocket/stream.hpp>
#include <memory>
#include <string>

#include "server/conversation/control_queue.h"
#include "server/socket/peer_context.h"

namespace kerf::net {

using WebSocket = boost::beast::websocket::stream<boost::beast::tcp_stream>;
using UpgradeRequest = boost::beast::http::request<boost::beast::http::empty_body>;

/// Larger frames close the connection with 1009 before they are read; those between the protocol's
/// limit and this one are answered with a typed error.
inline constexpr std::size_t kFrameReadMax = 64 * 1024;

/// Limit of error messages sent to one peer; errors beyond it are only counted.
inline constexpr double kErrorsPerS = 20;
inline constexpr double kErrorsBurst = 50;

/// Options that agents and viewers share: no compression (a shared frame is encoded once for all),
/// keep-alive pings, small frames in, sub-protocol out.
void prepare(WebSocket& socket, std::string_view protocol);

/// Microseconds of the server's monotonic clock, as frames carry them.
std::uint64_t clock_us();

/// Both take over an accepted socket whose upgrade request has been read and checked.
void serve_agent(boost::asio::ip::tcp::socket socket, UpgradeRequest request,
                 std::shared_ptr<Session> session, PeerContext& context);
void serve_viewer(boost::asio::ip::tcp::socket socket, UpgradeRequest request,
                  std::shared_ptr<Session> session, PeerContext& context);

}  // namespace kerf::net
