// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <charconv>
#include <string>

namespace kerf {

// Decimal text of finite numbers, without exponent, independent of the locale.

/// The shortest decimal that reads back to the same double; "0" for -0.
std::string exact_text(double value);
/// Rounded to at most `decimals` decimals. Trailing zeros are removed.
std::string decimal_text(double value, int decimals);
/// Rounded to `digits` significant digits.
std::string significant_text(double value, int digits);

/// Like std::from_chars, but a number too small for a double is 0.
std::from_chars_result number_of_chars(const char* first, const char* last, double& value,
                                       std::chars_format format = std::chars_format::general);

}  // namespace kerf
