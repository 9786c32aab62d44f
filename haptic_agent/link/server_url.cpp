// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/link/server_url.h"

#include <algorithm>
#include <charconv>

#include "server/wire/limits.h"

namespace kerf::agent {
namespace {

constexpr std::string_view kDefaultPort = "8080", kDefaultTlsPort = "443";
constexpr int kMaxPort = 65535;

bool is_port(std::string_view text) noexcept {
  int port = 0;
  const auto [end, failed] = std::from_chars(text.data(), text.data() + text.size(), port);
  return failed == std::errc{} && end == text.data() + text.size() && port > 0 && port <= kMaxPort;
}

}  // namespace

std::string ServerUrl::authority() const {
  const bool is_v6 = host.find(':') != std::string::npos;
  return (is_v6 ? "[" + host + "]" : host) + ":" + port;
}

std::expected<ServerUrl, std::string> parse_server_url(std::string_view text) {
  bool tls = false;
  for (const std::string_view scheme : {"http://", "ws://", "https://", "wss://"}) {
    if (!text.starts_with(scheme)) continue;
    tls = scheme == "https://" || scheme == "wss://";
    text.remove_prefix(scheme.size());
    break;
  }
  if (text.find("://") != std::string_view::npos) {
    return std::unexpected("the server address must start with http://, https://, ws:// or wss://");
  }
  if (text.ends_with('/')) text.remove_suffix(1);
  if (text.find_first_of("/?# ") != std::string_view::npos) {
    return std::unexpected(
        "the server address must be a host and an optional port, without a path");
  }
  ServerUrl url{.host = {}, .port = std::string(tls ? kDefaultTlsPort : kDefaultPort), .tls = tls};
  std::string_view rest;
  if (text.starts_with('[')) {
    const std::size_t close = text.find(']');
    if (close == std::string_view::npos)
      return std::unexpected("the server address has an unclosed bracket");
    url.host = text.substr(1, close - 1);
    rest = text.substr(close + 1);
  } else {
    const std::size_t colon = text.find(':');
    url.host = text.substr(0, colon);
    rest = colon == std::string_view::npos ? std::string_view{} : text.substr(colon);
  }
  if (url.host.empty()) return std::unexpected("the server address has no host");
  if (rest.empty()) return url;
  if (rest.front() != ':' || !is_port(rest.substr(1))) {
    return std::unexpected("the server port must be a number from 1 to 65535");
  }
  url.port = rest.substr(1);
  return url;
}

std::optional<ServerUrl> follow_redirect(const ServerUrl& from, std::string_view redirect) {
  auto to = redirect.empty() ? std::nullopt : std::optional(parse_server_url(redirect));
  if (!to || !*to || (from.tls && !(*to)->tls)) return std::nullopt;
  return **std::move(to);
}

bool is_session_id(std::string_view text) noexcept {
  const auto allowed = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.' ||
           c == '_' || c == '-';
  };
  return !text.empty() && text.size() <= wire::kMaxSessionIdBytes && text.front() != '.' &&
         std::ranges::all_of(text, allowed);
}

}  // namespace kerf::agent
