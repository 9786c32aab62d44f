// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "server/store/resume_token.h"

namespace kerf {

/// The text with which the holder of a grant proves it: "kerf_", the grant's public id, "_" and a
/// secret of 128 random bits. The id finds the grant. Only the SHA-256 of the secret is stored, and
/// it is compared in constant time. Never logged.
struct AccessToken {
  static constexpr std::size_t kIdDigits = 12;

  std::string id;      ///< kIdDigits hexadecimal digits, unique on the server
  std::string secret;  ///< 32 hexadecimal digits

  std::string text() const { return "kerf_" + id + "_" + secret; }
};

/// Returns a new token, or nullopt if the system's random generator fails.
std::optional<AccessToken> new_access_token();
/// Parses a token, or nullopt for any other text.
std::optional<AccessToken> parse_access_token(std::string_view text);

/// The least length of the administrator's token.
inline constexpr std::size_t kAdminTokenBytesMin = 32;

}  // namespace kerf
