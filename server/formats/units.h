// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <numbers>

namespace kerf {

inline constexpr double kMmPerInch = 25.4;
inline constexpr double kRadPerDeg = std::numbers::pi / 180;
inline constexpr double kDegPerRad = 180 / std::numbers::pi;

}  // namespace kerf
