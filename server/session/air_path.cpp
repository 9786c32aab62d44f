// SPDX-License-Identifier: Apache-2.0
#include "server/session/air_path.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <variant>

namespace kerf {
namespace {

/// Maximum number of motions joined into one. Each new motion is compared with all of them.
constexpr std::size_t kJoinedMax = 256;
/// Maximum relative difference of the speeds of joined motions, caused by rounding to the pose
/// grid.
constexpr double kSpeedTolerance = 1e-3;

using Range = std::array<double, 2>;

/// Returns the extent, along one coordinate, of the cylinder around a tool.
Range extent(const MoveTool& move, const Tool& tool, double Vec3::* coordinate) {
  const double axis = move.from.axis.*coordinate;
  const double side = tool.whole_radius_mm * std::sqrt(std::max(0.0, 1 - axis * axis));
  const double along = tool.whole_length_mm * axis;
  const auto [low, high] = std::minmax(move.from.tip_mm.*coordinate, move.to.tip_mm.*coordinate);
  return {low + std::min(0.0, along) - side, high + std::max(0.0, along) + side};
}

double distance_from_line(Vec3 point, Vec3 from, Vec3 to) {
  const Vec3 along = to - from;
  const double squared = dot(along, along);
  const double share = squared > 0 ? std::clamp(dot(point - from, along) / squared, 0.0, 1.0) : 0.0;
  return length(point - (from + along * share));
}

double speed_of(const MoveTool& move) {
  return move.duration_s > 0 ? length(move.to.tip_mm - move.from.tip_mm) / move.duration_s : 0;
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

bool AirPath::continues(const MoveTool& move) const {
  if (joined_->tool != move.tool || !(joined_->to == move.from) ||
      between_mm_.size() + 1 >= kJoinedMax) {
    return false;
  }
  const double speed = speed_of(move);
  if (!(speed > 0) || std::abs(speed - speed_mm_per_s_) > kSpeedTolerance * speed_mm_per_s_) {
    return false;
  }
  // A reversal would retrace the path.
  const Vec3 ahead = joined_->to.tip_mm - joined_->from.tip_mm;
  if (dot(ahead, move.to.tip_mm - move.from.tip_mm) <= 0) return false;
  const auto is_near = [&](Vec3 tip) {
    return distance_from_line(tip, joined_->from.tip_mm, move.to.tip_mm) <= kAirToleranceMm;
  };
  return is_near(joined_->to.tip_mm) && std::ranges::all_of(between_mm_, is_near);
}

bool AirPath::add(const MoveTool& move) {
  if (!joined_) {
    joined_ = move;
    speed_mm_per_s_ = speed_of(move);
    return true;
  }
  if (!continues(move)) return false;
  between_mm_.push_back(joined_->to.tip_mm);
  joined_->to = move.to;
  joined_->duration_s += move.duration_s;
  return true;
}

void AirPath::clear() {
  joined_.reset();
  between_mm_.clear();
}

}  // namespace kerf
