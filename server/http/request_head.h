// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <expected>
#include <memory>
#include <string>
#include <string_view>

#include "server/http/api.h"
#include "server/http/browser_rules.h"
#include "server/http/routes.h"

namespace kerf::net {

/// The part of a request that decides about it before its body is read. No sockets, no Beast. The
/// views refer to the request.
struct RequestHead {
  std::string_view method, target;
  unsigned version = 11;  ///< of HTTP: 10 or 11
  std::size_t hosts = 1;  ///< number of Host headers
  std::string_view host, origin, cookie, authorization;
  std::string_view if_none_match, range, if_range, accept_encoding;
  bool is_secure = false;          ///< received over TLS
  std::string address = {};        ///< of the peer, or of the client of a trusted proxy
  bool is_forwarded = false;       ///< a proxy has added its client's address
  std::string forwarded_for = {};  ///< X-Forwarded-For, all values
  std::string_view forwarded_host, forwarded_proto;  ///< X-Forwarded-Host, -Proto
  std::string_view protocols, key;  ///< for an upgrade: offered sub-protocols, Sec-WebSocket-Key

  BrowserHeaders browser() const { return {host, origin, is_secure, target}; }
  bool reads_only() const { return method == "GET" || method == "HEAD"; }
};

/// Returns the request of a head, without its body. Returns an error response if the request has no
/// valid Host, addresses a foreign name or has a malformed target.
std::expected<ApiRequest, ApiResponse> screen(const RequestHead& head, const HttpOptions& options);

/// Returns the error response to a page of a foreign origin.
ApiResponse foreign_origin();

/// The session and caller of a WebSocket upgrade.
struct UpgradeTarget {
  Upgrade kind = Upgrade::kNone;
  std::shared_ptr<Session> session;  ///< null if another server runs it
  Caller caller;
  std::string redirect = {};       ///< address of that server
  std::string_view protocol = {};  ///< of the WebSocket
};

/// Returns the target of an upgrade, or the response that rejects it.
std::expected<UpgradeTarget, ApiResponse> open_upgrade(const RequestHead& head,
                                                       const ApiRequest& request, const Api& api,
                                                       const SessionRegistry& registry,
                                                       const HttpOptions& options);

}  // namespace kerf::net
