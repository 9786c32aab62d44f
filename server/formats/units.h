// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <numbers>
#include <optional>
#include <string_view>

namespace kerf {

inline constexpr double kMmPerInch = 25.4;
inline constexpr double kRadPerDeg = std::numbers::pi / 180;
inline constexpr double kDegPerRad = 180 / std::numbers::pi;

/// Returns the length of a unit of models, "mm", "cm", "m" or "inch", in mm, or nullopt.
inline std::optional<double> mm_of_unit(std::string_view name) {
  if (name == "mm") return 1;
  if (name == "cm") return 10;
  if (name == "m") return 1000;
  if (name == "inch") return kMmPerInch;
  return std::nullopt;
}

}  // namespace kerf
