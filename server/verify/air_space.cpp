// SPDX-License-Identifier: Apache-2.0
#include "server/verify/air_space.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <variant>

namespace kerf {
namespace {

using Range = std::array<double, 2>;

/// Returns the extent, along one coordinate, of the cylinder around a tool.
Range extent(const MoveTool& move, const Tool& tool, double Vec3::* coordinate) {
  const double axis = move.from.axis.*coordinate;
  const double side = tool.whole_radius_mm * std::sqrt(std::max(0.0, 1 - axis * axis));
  const double along = tool.whole_length_mm * axis;
  const auto [low, high] = std::minmax(move.from.tip_mm.*coordinate, move.to.tip_mm.*coordinate);
  return {low + std::min(0.0, along) - side, high + std::max(0.0, along) + side};
}

}  // namespace

AirSpace::AirSpace(const SculptureSettings& settings)
    : has_obstacles_(!settings.obstacles.empty()) {
  if (const auto* box = std::get_if<BoxStock>(&settings.stock)) {
    low_mm_ = box->min_mm;
    high_mm_ = box->max_mm;
  } else {
    const auto& cylinder = std::get<CylinderStock>(settings.stock);
    const double radius = cylinder.radius_mm;
    low_mm_ = {cylinder.center_x_mm - radius, cylinder.center_y_mm - radius, cylinder.min_z_mm};
    high_mm_ = {cylinder.center_x_mm + radius, cylinder.center_y_mm + radius, cylinder.max_z_mm};
  }
  const double margin = settings.pitch_mm + kAirToleranceMm;
  low_mm_ = low_mm_ - Vec3{margin, margin, margin};
  high_mm_ = high_mm_ + Vec3{margin, margin, margin};
}

bool AirSpace::contains(const MoveTool& move, const Tool& tool) const {
  return !has_obstacles_ && !move.feel && is_clear(move, tool);
}

bool AirSpace::is_clear(const MoveTool& move, const Tool& tool) const {
  if (!(move.from.axis == move.to.axis)) return false;
  return std::ranges::any_of(std::array{&Vec3::x, &Vec3::y, &Vec3::z}, [&](auto coordinate) {
    const Range range = extent(move, tool, coordinate);
    return range[1] < low_mm_.*coordinate || range[0] > high_mm_.*coordinate;
  });
}

}  // namespace kerf
