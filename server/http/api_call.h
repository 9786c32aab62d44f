// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <expected>
#include <map>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "server/http/byte_range.h"
#include "server/http/download_cache.h"
#include "server/rights/caller.h"

namespace kerf {
class Session;
}

namespace kerf::net {

struct ApiServices;

/// An HTTP request, independent of sockets and Beast.
struct ApiRequest {
  std::string method;                        ///< GET, HEAD, POST, DELETE
  std::vector<std::string> path;             ///< decoded segments, e.g. {"v1", "sessions"}
  std::map<std::string, std::string> query;  ///< decoded; the first value of a repeated name
  std::string repeated = {};                 ///< name of a repeated parameter; empty if none
  std::string target;                        ///< path and query as sent
  std::string if_none_match, range, if_range, accept_encoding;
  std::string token;          ///< from the Authorization header, else `pass`; empty if none
  std::string pass;           ///< from the Cookie header; empty if none
  std::string host;           ///< as addressed by the client
  std::string network;        ///< of the client (network_of)
  bool is_secure = false;     ///< received over TLS
  bool is_script = false;     ///< sent by a page, whose browser may not follow to another origin
  bool is_forwarded = false;  ///< a proxy has added its client's address
  std::string body;
  /// Requested when the client is gone, the session is closed or the server stops.
  std::stop_token stop = {};

  /// Returns the value of a query parameter; null if it is missing.
  const std::string* query_value(const std::string& name) const {
    const auto found = query.find(name);
    return found == query.end() ? nullptr : &found->second;
  }
};

struct ApiResponse {
  unsigned status = 200;
  std::string content_type = "application/json";
  std::string body;
  std::shared_ptr<const std::string> text;  ///< shared body, instead of `body`
  std::shared_ptr<const OpenFile> file;     ///< file body, instead of `body`
  std::optional<ByteRange> part;            ///< part of the file to send; nullopt for all of it
  std::vector<std::pair<std::string, std::string>> headers;
};

/// Parses the path and query of a request target. The error names the malformed part.
std::expected<ApiRequest, std::string> parse_target(std::string_view target);

/// A request to a route of the table (routes.h).
struct ApiCall {
  const ApiRequest& request;
  std::shared_ptr<Session> session;  ///< the session in the path; null if the path is not below one
  std::string captured;              ///< RouteMatch::captured
  Caller caller;                     ///< its right to the route has been checked
  ApiServices& services;             ///< of this server
};

}  // namespace kerf::net
