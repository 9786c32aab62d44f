// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <ranges>
#include <string>
#include <string_view>

#include "kernel/math/vec3.h"
#include "server/http/number.h"

namespace kerf::net {

inline constexpr double kPlaceMaxMm = 1e6;

/// Parses a point "X,Y,Z". Nullopt if the parameter is missing or is not three numbers of at most
/// kPlaceMaxMm.
inline std::optional<Vec3> parse_place(const std::string* text) {
  if (text == nullptr) return std::nullopt;
  std::array<double, 3> values{};
  std::size_t count = 0;
  for (const auto part : std::views::split(*text, ',')) {
    const auto number = parse_number<double>(std::string_view(part.begin(), part.end()));
    if (!number || !(std::abs(*number) <= kPlaceMaxMm) || count == values.size()) {
      return std::nullopt;
    }
    values.at(count++) = *number;
  }
  if (count != values.size()) return std::nullopt;
  return Vec3{values[0], values[1], values[2]};
}

}  // namespace kerf::net
