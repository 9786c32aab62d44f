// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace kerf::agent {

/// Returns a finite number rounded to `digits` significant digits, in plain decimals without
/// trailing zeros: 150 and 0.028, never 1.5e+02.
std::string plain_number(double value, int digits);

}  // namespace kerf::agent
