// SPDX-License-Identifier: Apache-2.0
#include "server/http/request_head.h"

#include <algorithm>
#include <ranges>
#include <string>

#include "server/http/cookie.h"
#include "server/http/proxies.h"
#include "server/http/responses.h"
#include "server/http/session_lookup.h"
#include "server/wire/control.h"

namespace kerf::net {
namespace {

/// Length of a Sec-WebSocket-Key.
constexpr std::size_t kKeyBytes = 24;

std::string_view without_blanks(std::string_view text) {
  constexpr std::string_view kBlanks = " \t";
  const auto first = std::min(text.find_first_not_of(kBlanks), text.size());
  text.remove_prefix(first);
  return text.substr(0, text.find_last_not_of(kBlanks) + 1);
}

bool offers(std::string_view protocols, std::string_view protocol) {
  return std::ranges::any_of(std::views::split(protocols, ','), [&](const auto& part) {
    return without_blanks({part.begin(), part.end()}) == protocol;
  });
}

/// HTTP/1.1 requires one Host header (RFC 9112, 3.2). With two, a proxy and this server might see
/// different hosts.
bool has_valid_host(const RequestHead& head) {
  return head.hosts == 1 || (head.hosts == 0 && head.version == 10);
}

}  // namespace

std::expected<ApiRequest, ApiResponse> screen(const RequestHead& head, const HttpOptions& options) {
  if (!has_valid_host(head)) {
    return std::unexpected(
        error_response(400, "bad_host", "the request must have one Host header"));
  }
  if (!host_allowed(head.host, options)) {
    return std::unexpected(error_response(421, "bad_host",
                                          "the server is not addressed by this name; name it with "
                                          "--allow-host, or use its IP address"));
  }
  auto request = parse_target(head.target);
  if (!request) return std::unexpected(error_response(400, "bad_target", request.error()));
  request->method = std::string(head.method);
  request->if_none_match = std::string(head.if_none_match);
  request->range = std::string(head.range);
  request->if_range = std::string(head.if_range);
  request->accept_encoding = std::string(head.accept_encoding);
  request->pass = pass_of_cookies(head.cookie);
  request->token = bearer_token(head.authorization);
  if (request->token.empty()) request->token = request->pass;
  request->is_secure = head.is_secure;
  request->is_script = !head.origin.empty();
  request->host = std::string(head.host);
  request->network = network_of(head.address);
  request->is_forwarded = head.is_forwarded;
  return *std::move(request);
}

ApiResponse foreign_origin() {
  return error_response(403, "bad_origin", "this origin is not allowed (--allow-origin)");
}

std::expected<UpgradeTarget, ApiResponse> open_upgrade(const RequestHead& head,
                                                       const ApiRequest& request, const Api& api,
                                                       const SessionRegistry& registry,
                                                       const HttpOptions& options) {
  const RouteMatch match = api.routes().match(request.method, request.path);
  if (match.upgrade == Upgrade::kNone) {
    return std::unexpected(error_response(404, "not_found", "there is no WebSocket at this path"));
  }
  UpgradeTarget target{match.upgrade, nullptr, {}};
  if (auto rejection = api.refuse(request, match, target.caller)) {
    return std::unexpected(*std::move(rejection));
  }
  const std::string& id = request.path[2];
  if (!target.caller.belongs_elsewhere) {
    target.session = only_looks(match) ? find_to_look(registry, id) : registry.find(id);
  }
  if (!target.session) target.redirect = other_place(registry, id).value_or("");
  if (!target.session && target.redirect.empty()) {
    return std::unexpected(no_session(registry, id, request.target));
  }
  if (!origin_allowed(head.browser(), options)) return std::unexpected(foreign_origin());
  target.protocol = match.upgrade == Upgrade::kAgent ? wire::kAgentProtocol : wire::kViewProtocol;
  if (!offers(head.protocols, target.protocol)) {
    return std::unexpected(error_response(
        400, "bad_protocol", "Sec-WebSocket-Protocol must list " + std::string(target.protocol)));
  }
  // Beast does not check it.
  if (head.key.size() != kKeyBytes) {
    return std::unexpected(
        error_response(400, "bad_request", "Sec-WebSocket-Key must be 16 bytes in base64"));
  }
  return target;
}

}  // namespace kerf::net
