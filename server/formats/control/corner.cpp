// SPDX-License-Identifier: Apache-2.0
#include "server/formats/control/corner.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace kerf {
namespace {

constexpr double kStraightRad = 1e-9;

}  // namespace

std::expected<CornerPath, CornerFault> corner_path(PlanePoint from, PlanePoint corner,
                                                   PlanePoint to, const CornerSize& size,
                                                   double tolerance_mm) {
  if (std::abs(from.normal - corner.normal) > tolerance_mm ||
      std::abs(to.normal - corner.normal) > tolerance_mm)
    return std::unexpected(CornerFault::kNotLevel);
  const double in = direction(from, corner), out = direction(corner, to);
  const double turn = std::remainder(out - in, 2 * std::numbers::pi);
  const double reach = size.leg_mm > 0       ? size.leg_mm
                       : size.chamfer_mm > 0 ? size.chamfer_mm / (2 * std::cos(turn / 2))
                                             : size.radius_mm * std::abs(std::tan(turn / 2));
  if (!(reach <= std::min(distance(from, corner), distance(corner, to)) + tolerance_mm))
    return std::unexpected(CornerFault::kTooLarge);
  CornerPath path{.start = offset_point(corner, -reach, in),
                  .end = offset_point(corner, reach, out),
                  .center = {},
                  .straight_on = std::abs(turn) < kStraightRad};
  if (size.leg_mm > 0 || size.chamfer_mm > 0 || path.straight_on) return path;
  path.turns = turn > 0 ? 1 : -1;
  path.center = offset_point(path.start, size.radius_mm, in + path.turns * std::numbers::pi / 2);
  return path;
}

}  // namespace kerf
