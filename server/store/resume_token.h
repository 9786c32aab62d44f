// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace kerf {

/// SHA-256 of a resume token, the form in which tokens are stored.
inline constexpr std::size_t kTokenHashBytes = 32;
using TokenHash = std::array<std::byte, kTokenHashBytes>;

/// Returns a new resume token: 128 random bits as 32 lowercase hexadecimal digits. Nullopt if the
/// system's random generator fails. Its bearer continues as the participant that it was given to,
/// so never log it.
std::optional<std::string> random_token();
/// Returns the SHA-256 of a token's text; nullopt if the text is malformed.
std::optional<TokenHash> hash_token(std::string_view token);
/// Returns the SHA-256 of any secret text; nullopt if the system's library fails.
std::optional<TokenHash> hash_secret(std::string_view secret);
/// Compares in constant time.
bool are_equal(const TokenHash& a, const TokenHash& b);

}  // namespace kerf
