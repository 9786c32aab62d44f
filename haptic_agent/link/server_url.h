// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <expected>
#include <string>
#include <string_view>

namespace kerf::agent {

/// Where a server listens.
struct ServerUrl {
  std::string host;
  std::string port;

  bool operator==(const ServerUrl&) const = default;
};

/// Reads `http://HOST[:PORT]`, `ws://…` or plain `HOST[:PORT]`; an IPv6 address stands in brackets.
/// The port is 8080 unless given. The error is one sentence.
std::expected<ServerUrl, std::string> parse_server_url(std::string_view text);

/// True for the names that a session may have: letters, digits, `.`, `_`, `-`, not too many.
bool is_session_id(std::string_view text) noexcept;

}  // namespace kerf::agent
