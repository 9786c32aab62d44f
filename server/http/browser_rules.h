// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "server/http/api_call.h"
#include "server/http/http_options.h"

namespace kerf::net {

/// The headers by which a browser identifies the server and the page of a request.
struct BrowserHeaders {
  std::string_view host, origin;  ///< empty if missing
  bool is_secure = false;         ///< the request came over TLS
  std::string_view target = {};   ///< from the request line
};

/// Returns whether the Host header names this server: an IP address, localhost, the host of an
/// allowed origin, or an allowed host. Any other name could be one that an attacker's DNS has
/// pointed here ("DNS rebinding"), and the attacker's page would have this server's origin. IP
/// addresses cannot be such names. A missing header is allowed because browsers always send one.
bool host_allowed(std::string_view host, const HttpOptions& options);

/// Returns whether a page of this origin may change sessions and open WebSockets. True for the
/// server's own origin, whose host must be allowed, for listed origins, and for clients that are
/// not browsers.
bool origin_allowed(const BrowserHeaders& headers, const HttpOptions& options);

/// Adds the headers that restrict how browsers use a response: no sniffing of types, no framing, no
/// foreign resources, no referrers. Only the page at `/?embed`, which changes nothing, may be
/// framed, by sites of `embed_origins`. Pages of listed origins may read the response (CORS), and
/// those of cluster servers may do so with the browser's pass. Over TLS, asks browsers to use only
/// TLS for this host (HSTS), except for localhost, where other ports are other programs.
void add_browser_headers(const BrowserHeaders& headers, const HttpOptions& options,
                         ApiResponse& response);

/// Returns whether a text is the address of a server: http:// or https://, a name or IP address,
/// and an optional port.
bool is_server_address(std::string_view text);

/// Returns the answer to a CORS preflight of an allowed origin for a resource with these methods.
ApiResponse preflight(std::string_view methods);

}  // namespace kerf::net
