// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <expected>
#include <optional>

#include "server/formats/control/plane.h"

namespace kerf {

/// The size of a corner between two straight moves, mm: one length is above 0.
struct CornerSize {
  double radius_mm = 0;   ///< of the arc that rounds it
  double chamfer_mm = 0;  ///< length of the chamfer that cuts it
  double leg_mm = 0;      ///< length that a chamfer takes from each move
};

/// A rounded or cut corner: a line or an arc from `start` on the first move to `end` on the second.
struct CornerPath {
  PlanePoint start, end;
  std::optional<PlanePoint> center;  ///< of the arc
  int turns = 0;                     ///< of the arc: 1 counterclockwise, -1 clockwise
  bool straight_on = false;          ///< the second move continues the first
};

enum class CornerFault {
  kNotLevel,  ///< a move leaves the plane
  kTooLarge   ///< a move is shorter than the corner
};

/// Lengths and heights that differ by less count as equal, mm.
inline constexpr double kCornerToleranceMm = 1e-9;

/// Computes the corner at `corner` between the moves from `from` and to `to`.
std::expected<CornerPath, CornerFault> corner_path(PlanePoint from, PlanePoint corner,
                                                   PlanePoint to, const CornerSize& size,
                                                   double tolerance_mm = kCornerToleranceMm);

}  // namespace kerf
