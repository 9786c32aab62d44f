// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace kerf {

/// Heights above the tool's tip between which a piece lies, and its greatest radius: the upright
/// cylinder around it.
struct Extent {
  double z0_mm, z1_mm, radius_mm;
};

/// A radius below zero: the piece has no point at that height.
inline constexpr double kNoRadiusMm = -1;

}  // namespace kerf
