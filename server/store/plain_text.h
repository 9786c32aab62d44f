// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string_view>

namespace kerf {

/// Whether a text is well-formed UTF-8 of 1 to `bytes_max` bytes without ASCII control characters.
bool is_plain_text(std::string_view text, std::size_t bytes_max);

}  // namespace kerf
