// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string_view>

namespace kerf {

/// Returns the line, from 1, whose comment states a size in inches ("1/2 IN", ".500IN", 3/8"), if
/// the program has no G20, G21, G70 or G71 and no comment states a size in mm; otherwise 0. A
/// control starts in the unit of its settings: such a program is for one in inches.
std::size_t line_of_inches(std::string_view program);

}  // namespace kerf
