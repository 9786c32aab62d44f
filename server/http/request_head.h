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

/// The part of a request before its body that decides what the server does with it; no sockets, no
/// Beast. The texts belong to the request.
struct RequestHead {
  std::string_view method, target;
  unsigned version = 11;  ///< of HTTP: 10 or 11
  std::size_t hosts = 1;  ///< number of Host headers
  std::string_view host, origin, cookie, authorization;
  std::string_view if_none_match, range, if_range, accept_encoding;
  bool is_secure = false;          ///< it has come over TLS
  std::string address = {};        ///< of the peer, or of the client behind a trusted proxy
  bool is_forwarded = false;       ///< a proxy has added the address of its client
  std::string forwarded_for = {};  ///< X-Forwarded-For, all of them
  std::string_view forwarded_host, forwarded_proto;  ///< X-Forwarded-Host, -Proto
  std::string_view protocols, key;  ///< of an upgrade: sub-protocols offered, Sec-WebSocket-Key

  BrowserHeaders browser() const { return {host, origin, is_secure, target}; }
  bool reads_only() const { return method == "GET" || method == "HEAD"; }
};

/// Returns the request of a head, without its body, or the response to one that is not for this
/// server: without a valid Host, addressed by a foreign name, with a malformed target.
std::expected<ApiRequest, ApiResponse> screen(const RequestHead& head, const HttpOptions& options);

/// Returns the response to a page of a foreign origin.
ApiResponse foreign_origin();

/// The session whose WebSocket a request asks for, and who asks.
struct UpgradeTarget {
  Upgrade kind = Upgrade::kNone;
  std::shared_ptr<Session> session;  ///< null: it is at another server
  Caller caller;
  std::string redirect = {};       ///< the address of that server
  std::string_view protocol = {};  ///< of the WebSocket
};

/// Returns the target of an upgrade, or the response to one that is rejected.
std::expected<UpgradeTarget, ApiResponse> open_upgrade(const RequestHead& head,
                                                       const ApiRequest& request, const Api& api,
                                                       const SessionRegistry& registry,
                                                       const HttpOptions& options);

}  // namespace kerf::net
