// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "server/http/api.h"
#include "server/http/http_options.h"

namespace kerf::net {

/// The headers of a request by which a browser says what it talks to and for which page.
struct BrowserHeaders {
  std::string_view host, origin;  ///< empty if missing
  bool is_secure = false;         ///< the page has come over TLS
  std::string_view target = {};   ///< of the request line
};

/// Returns whether the Host header names this server: an IP address, localhost, the host of an
/// allowed origin, or an allowed host. Another name may be one that an attacker's DNS has pointed
/// here ("DNS rebinding"): to the browser, the attacker's page then has the origin of this server.
/// An IP address cannot be such a name. A missing header is allowed: browsers send it.
bool host_allowed(std::string_view host, const HttpOptions& options);

/// Returns whether a page of this origin may change sessions and open WebSockets: it is the
/// server's own, whose host must be allowed, or listed, or the client is no browser.
bool origin_allowed(const BrowserHeaders& headers, const HttpOptions& options);

/// Adds the headers that restrict what a browser does with a response: content is what its type
/// says, nothing frames it, the page loads nothing from elsewhere, and no address is sent to other
/// sites. Sites of `embed_origins` may frame the page at `/?embed`, which changes nothing, and
/// nothing else. Pages of listed origins may read the response (CORS), those of the servers of a
/// cluster with the browser's pass. Over TLS, browsers are asked
/// to use nothing else for this host (HSTS), but for localhost, where other ports are other
/// programs.
void add_browser_headers(const BrowserHeaders& headers, const HttpOptions& options,
                         ApiResponse& response);

/// Returns whether a text is the address of a server: http:// or https://, a name or an IP address,
/// and perhaps a port.
bool is_server_address(std::string_view text);

/// Returns the answer to a CORS preflight of an allowed origin for a resource with these methods.
ApiResponse preflight(std::string_view methods);

}  // namespace kerf::net
