// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <string_view>

namespace kerf {

/// Number of different colors of default_color().
inline constexpr std::size_t kDefaultColors = 8;

/// Returns the color of the n-th tool or person without a chosen one: one of eight hues that remain
/// distinguishable with color-vision deficiency.
constexpr const char* default_color(std::size_t n) {
  constexpr std::array<const char*, kDefaultColors> kColors = {
      "#d9541e", "#0072b2", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#8c6d31", "#6f4fa0"};
  return kColors[n % kColors.size()];
}

/// Whether a text has the form #rrggbb.
constexpr bool is_color(std::string_view text) {
  return text.size() == 7 && text.front() == '#' &&
         text.find_first_not_of("0123456789abcdefABCDEF", 1) == std::string_view::npos;
}

}  // namespace kerf
