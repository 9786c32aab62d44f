// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <expected>
#include <optional>
#include <string>
#include <string_view>

namespace kerf::agent {

/// Address of a server.
struct ServerUrl {
  std::string host;
  std::string port;
  bool tls = false;

  bool operator==(const ServerUrl&) const = default;
  /// HOST:PORT, an IPv6 address in brackets, as in the header `Host`.
  std::string authority() const;
};

/// Parses `http://HOST[:PORT]`, `ws://…` or `HOST[:PORT]` (default port 8080), or `https://…` or
/// `wss://…` for TLS (default port 443). An IPv6 address is in brackets. The error is one sentence.
std::expected<ServerUrl, std::string> parse_server_url(std::string_view text);

/// Returns the server at which a session continues according to the server `from`, or nullopt if
/// the address is invalid or would downgrade the agent from TLS to plain text.
std::optional<ServerUrl> follow_redirect(const ServerUrl& from, std::string_view redirect);

/// Returns true for a valid session identifier: letters, digits, `.`, `_`, `-`; at most
/// kMaxSessionIdBytes, not starting with `.`.
bool is_session_id(std::string_view text) noexcept;

}  // namespace kerf::agent
