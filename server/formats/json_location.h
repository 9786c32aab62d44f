// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string_view>

namespace kerf {

/// A position in a text. Both count from 1.
struct TextPlace {
  std::size_t line = 1, column = 1;
};

/// Returns the position of a byte.
TextPlace place_of(std::string_view text, std::size_t byte);

/// Returns the position of the value at `path`, e.g. "tools[0].diameter_mm", in valid JSON. If
/// there is no such value, the position of the innermost enclosing value that exists.
TextPlace locate_json(std::string_view text, std::string_view path);

}  // namespace kerf
