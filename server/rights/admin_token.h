// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <expected>
#include <string>

namespace kerf {

/// Returns the administrator's token: the first line of `file`, or, without a file, the environment
/// variable KERF_ADMIN_TOKEN, or empty without either. A missing file is created, with a random
/// token that only its owner can read. It is never a command-line argument, which every user of the
/// machine could read. The error is one sentence.
std::expected<std::string, std::string> read_admin_token(const std::string& file);

}  // namespace kerf
