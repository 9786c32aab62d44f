// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <expected>
#include <string>
#include <string_view>

namespace kerf::agent {

/// Returns whether a text is a valid token: it is sent in an HTTP header.
bool is_token(std::string_view text) noexcept;

/// Returns the token for a server: the first line of `file`, or if `file` is empty, the environment
/// variable KERF_TOKEN; "" if there is neither. From an invitation's link it takes the part after
/// "#invite=". Command-line arguments are no source, because every user of the machine can read
/// them. The error is one sentence and does not contain the token.
std::expected<std::string, std::string> read_token(const std::string& file);

}  // namespace kerf::agent
