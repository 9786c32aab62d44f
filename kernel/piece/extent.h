// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace kerf {

/// The upright cylinder around a piece: its heights above the tool's tip and its greatest radius.
struct Extent {
  double z0_mm, z1_mm, radius_mm;
};

/// A radius below zero: the piece has no point at that height.
inline constexpr double kNoRadiusMm = -1;

}  // namespace kerf
