// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "server/http/api_call.h"

namespace kerf::net {

/// The properties of a response that depend on its request.
struct ResponseFraming {
  unsigned version = 11;           ///< of HTTP: 10 or 11
  std::string_view reason = "OK";  ///< reason phrase of the status
  bool keep_alive = true;          ///< whether the connection stays open
};

/// Returns the Content-Length of `response` to GET and HEAD.
std::uint64_t content_length(const ApiResponse& response);

/// Returns the status line and header fields of `response`, with the final empty line (RFC 9112,
/// 2.1).
std::string response_head(const ApiResponse& response, const ResponseFraming& framing);

}  // namespace kerf::net
