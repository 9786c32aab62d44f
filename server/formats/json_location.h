// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string_view>

namespace kerf {

/// A place in a text, from 1.
struct TextPlace {
  std::size_t line = 1, column = 1;
};

/// The place of a byte.
TextPlace place_of(std::string_view text, std::size_t byte);

/// Where the value at `path` (as in "tools[0].diameter_mm") stands in a JSON text that is known to
/// be valid; where there is no such value, the nearest thing around it.
TextPlace locate_json(std::string_view text, std::string_view path);

}  // namespace kerf
