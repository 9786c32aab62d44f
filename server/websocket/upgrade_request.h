// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/message.hpp>

namespace kerf::net {

/// The request of a client that asks for a WebSocket, as HTTP has read it.
struct UpgradeRequest {
  boost::beast::http::request<boost::beast::http::empty_body> message;
};

}  // namespace kerf::net
