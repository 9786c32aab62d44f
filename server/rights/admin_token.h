// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <expected>
#include <string>

namespace kerf {

/// Returns the administrator's token: the first line of `file`, or, without a file, the environment
/// variable KERF_ADMIN_TOKEN; empty if there is neither. A file that does not exist is made, with a
/// random token that only its owner can read. Never an argument of the command line, which every
/// user of the machine could read. The error is one sentence.
std::expected<std::string, std::string> read_admin_token(const std::string& file);

}  // namespace kerf
