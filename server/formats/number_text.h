// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace kerf {

/// Shortest decimal without exponent that reads back to the same double; "0" for -0.
std::string exact_text(double value);
/// `value` with this many decimals at most, trailing zeros removed.
std::string decimal_text(double value, int decimals);
/// `value` rounded to this many significant digits, without exponent.
std::string significant_text(double value, int digits);

}  // namespace kerf
