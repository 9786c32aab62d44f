// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "server/http/api.h"

namespace kerf::net {

/// The protocol side of a response, which its request decides.
struct ResponseFraming {
  unsigned version = 11;           ///< of HTTP: 10 or 11
  std::string_view reason = "OK";  ///< phrase of the status
  bool keep_alive = true;          ///< whether the connection remains open
};

/// Returns the number of bytes of the body that `response` announces to GET and HEAD.
std::uint64_t content_length(const ApiResponse& response);

/// Returns the status line and the header fields of `response` with the empty line behind them (RFC
/// 9112, 2.1).
std::string response_head(const ApiResponse& response, const ResponseFraming& framing);

}  // namespace kerf::net
