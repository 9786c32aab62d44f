// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <boost/asio/awaitable.hpp>
#include <boost/asio/ip/tcp.hpp>

#include "server/http/http_context.h"

namespace kerf::net {

/// Serves one connection, request by request, until it closes or becomes a WebSocket. Runs on the
/// viewers' thread.
boost::asio::awaitable<void> serve_http(boost::asio::ip::tcp::socket socket, HttpContext& context);

}  // namespace kerf::net
