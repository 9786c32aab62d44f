// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace kerf {

/// Returns a text as content or attribute value of SVG and HTML: valid UTF-8, with invalid bytes as
/// U+FFFD, without control characters, with & < > " as entities.
std::string escaped(std::string_view text);

/// Formats a number with a printf format of a double.
std::string formatted(const char* format, double value);

}  // namespace kerf
