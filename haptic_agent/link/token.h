// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <expected>
#include <string>
#include <string_view>

namespace kerf::agent {

/// Returns whether a text may be a token: it goes into an HTTP header.
bool is_token(std::string_view text) noexcept;

/// Returns the token that a server asks for: the first line of `file`, or, if it is empty, the
/// environment variable KERF_TOKEN; "" if there is neither. Of an invitation's link, the part after
/// "#invite=" is taken. Never an argument of the command line, which every user of the machine
/// could read. The error is one sentence and does not contain the token.
std::expected<std::string, std::string> read_token(const std::string& file);

}  // namespace kerf::agent
