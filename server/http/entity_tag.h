// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "server/http/api_call.h"

namespace kerf::net {

/// Returns whether `If-None-Match` names the tag, quotes included, or is `*`.
inline bool is_named(const std::string& if_none_match, const std::string& etag) {
  return if_none_match == "*" || if_none_match.find(etag) != std::string::npos;
}

/// Adds an ETag header with `etag` (quotes included) for a file that clients may keep but must
/// revalidate. If the client has that file (`If-None-Match` names the tag or is `*`), completes the
/// response as a 304 and returns true.
inline bool has_client(const ApiRequest& request, const std::string& etag, ApiResponse& response) {
  response.headers.emplace_back("ETag", etag);
  response.headers.emplace_back("Cache-Control", "no-cache");
  if (!is_named(request.if_none_match, etag)) return false;
  response.status = 304;
  return true;
}

}  // namespace kerf::net
