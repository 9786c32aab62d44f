// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/message.hpp>

namespace kerf::net {

/// A client's request for a WebSocket, as read by HTTP.
struct UpgradeRequest {
  boost::beast::http::request<boost::beast::http::empty_body> message;
};

}  // namespace kerf::net
