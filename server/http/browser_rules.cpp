// SPDX-License-Identifier: Apache-2.0
#include "server/http/browser_rules.h"

#include <arpa/inet.h>

#include <algorithm>
#include <cctype>
#include <cstdint>

#include "server/http/number.h"

namespace kerf::net {
namespace {

bool is_equal(std::string_view one, std::string_view other) {
  return std::ranges::equal(one, other, [](unsigned char a, unsigned char b) {
    return std::tolower(a) == std::tolower(b);
  });
}

/// Removes ":PORT" and the brackets of an IPv6 address. Empty if malformed.
std::string_view name_of(std::string_view host) {
  const bool in_brackets = host.starts_with('[');
  const auto end = std::min(host.find(in_brackets ? ']' : ':'), host.size());
  std::string_view port = host.substr(end);
  if (in_brackets && !port.empty()) port.remove_prefix(1);
  const bool is_port = port.empty() || (port.front() == ':' && port.size() <= 6 &&
                                        port.find_first_not_of("0123456789", 1) == port.npos);
  if (!is_port || (in_brackets && end == host.size())) return "";
  return in_brackets ? host.substr(1, end - 1) : host.substr(0, end);
}

bool is_address(const std::string& name) {
  in6_addr address{};
  return inet_pton(AF_INET, name.c_str(), &address) == 1 ||
         inet_pton(AF_INET6, name.c_str(), &address) == 1;
}

std::string_view host_of(std::string_view origin) {
  const auto scheme = origin.find("://");
  return scheme == origin.npos ? "" : origin.substr(scheme + 3);
}

std::vector<std::string> list_of(const std::function<std::vector<std::string>()>& servers) {
  return servers ? servers() : std::vector<std::string>{};
}

/// Returns whether an origin is a server of the cluster.
bool is_of_cluster(std::string_view origin, const HttpOptions& options) {
  const auto servers = list_of(options.page_servers);
  return std::ranges::find(servers, origin) != servers.end();
}

bool is_listed(std::string_view origin, const HttpOptions& options) {
  if (origin.empty()) return false;
  return std::ranges::find(options.allow_origins, origin) != options.allow_origins.end() ||
         is_of_cluster(origin, options);
}

/// Returns whether a target is the page for framing by other sites. The viewer reads the same
/// parameter and then only shows the picture.
bool is_embed(std::string_view target) {
  const auto request = parse_target(target);
  return request && request->path.empty() && request->query_value("embed") != nullptr;
}

/// Returns the value of frame-ancestors: the sites that may frame the response.
std::string frames_of(const BrowserHeaders& headers, const HttpOptions& options, bool is_page) {
  if (!is_page || options.embed_origins.empty() || !is_embed(headers.target)) return "'none'";
  std::string origins;
  for (const std::string& origin : options.embed_origins) {
    origins.append(origins.empty() ? "" : " ").append(origin);
  }
  return origins;
}

/// Returns the policy of the viewer: its mesh decoder is WebAssembly, and it sets colors in style
/// attributes.
std::string page_policy(const BrowserHeaders& headers, const HttpOptions& options) {
  std::string own = "'self'";
  // Some browsers do not count WebSockets as 'self'.
  const std::string_view host = headers.host;
  if (!host.empty() && !headers.is_secure) own.append(" ws://").append(host);
  if (!host.empty()) own.append(" wss://").append(host);
  for (const std::string& server : list_of(options.other_servers)) {
    // "http:" does not cover "ws:". The hand connects to the owner of a session.
    own.append(" ").append(server).append(" ws").append(server.substr(std::string("http").size()));
  }
  return "default-src 'self'; script-src 'self' 'wasm-unsafe-eval'; style-src 'self' "
         "'unsafe-inline'; img-src 'self' data: blob:; font-src 'self' data:; worker-src 'self' "
         "blob:; connect-src " +
         own + " data: blob:; object-src 'none'; base-uri 'none'; form-action 'self'";
}

/// Returns the policy of a single file. For a script it applies in workers: Firefox gives a worker
/// WebAssembly modules, even compiled ones, only if the policy allows them.
std::string file_policy(std::string_view content_type) {
  const bool is_script = content_type.starts_with("text/javascript");
  return is_script ? "default-src 'none'; script-src 'self' 'wasm-unsafe-eval'"
                   : "default-src 'none'";
}

}  // namespace

bool host_allowed(std::string_view host, const HttpOptions& options) {
  if (host.empty()) return true;
  const std::string name(name_of(host));
  if (name.empty()) return false;
  if (is_address(name) || is_equal(name, "localhost")) return true;
  const auto names_it = [&](std::string_view allowed) {
    return is_equal(name, name_of(allowed)) || is_equal(host, allowed);
  };
  return std::ranges::any_of(options.allow_hosts, names_it) ||
         std::ranges::any_of(options.allow_origins,
                             [&](const std::string& origin) { return names_it(host_of(origin)); });
}

bool origin_allowed(const BrowserHeaders& headers, const HttpOptions& options) {
  if (headers.origin.empty() || is_listed(headers.origin, options)) return true;
  const std::string_view own = host_of(headers.origin);
  return !own.empty() && is_equal(own, headers.host) && host_allowed(headers.host, options);
}

void add_browser_headers(const BrowserHeaders& headers, const HttpOptions& options,
                         ApiResponse& response) {
  const auto add = [&](const char* name, std::string value) {
    response.headers.emplace_back(name, std::move(value));
  };
  const bool is_page = response.content_type.starts_with("text/html");
  const std::string frames = frames_of(headers, options, is_page);
  add("Content-Security-Policy",
      (is_page ? page_policy(headers, options) : file_policy(response.content_type)) +
          "; frame-ancestors " + frames);
  add("X-Content-Type-Options", "nosniff");
  if (frames == "'none'") add("X-Frame-Options", "DENY");  // X-Frame-Options cannot name origins
  add("Referrer-Policy", "no-referrer");
  if (headers.is_secure && !is_equal(name_of(headers.host), "localhost")) {
    add("Strict-Transport-Security", "max-age=15552000");
  }
  if (options.allow_origins.empty() && !options.page_servers) return;
  add("Vary", "Origin");
  if (!is_listed(headers.origin, options)) return;
  add("Access-Control-Allow-Origin", std::string(headers.origin));
  // Allows the pass of an invitation, which browsers do not send to pages of other sites
  // (SameSite).
  if (is_of_cluster(headers.origin, options)) add("Access-Control-Allow-Credentials", "true");
  add("Access-Control-Expose-Headers",
      "Accept-Ranges, Content-Disposition, Content-Range, ETag, Location, Retry-After");
}

bool is_server_address(std::string_view text) {
  constexpr std::size_t kBytesMax = 200;
  if (!text.starts_with("http://") && !text.starts_with("https://")) return false;
  const std::string_view host = host_of(text);
  const std::string name(name_of(host));
  if (text.size() > kBytesMax || name.empty()) return false;
  const bool in_brackets = host.starts_with('[');
  const bool is_name = std::ranges::all_of(name, [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '.' || c == '-' || c == '_';
  });
  if (in_brackets ? !is_address(name) : !is_name) return false;
  const std::size_t colon = host.find(':', in_brackets ? host.find(']') : 0);
  if (colon == host.npos) return true;
  const auto port = parse_number<std::uint16_t>(host.substr(colon + 1));
  return port && *port > 0;
}

ApiResponse preflight(std::string_view methods) {
  ApiResponse response;
  response.status = 204;
  response.headers.emplace_back("Access-Control-Allow-Methods", std::string(methods));
  response.headers.emplace_back("Access-Control-Allow-Headers",
                                "Authorization, Content-Type, If-None-Match, If-Range, Range");
  response.headers.emplace_back("Access-Control-Max-Age", "600");
  return response;
}

}  // namespace kerf::net
