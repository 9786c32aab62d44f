// SPDX-License-Identifier: Apache-2.0
#include "server/session/air_path.h"

#include <algorithm>
#include <cmath>

namespace kerf {
namespace {

/// Maximum number of motions joined into one. Each new motion is compared with all of them.
constexpr std::size_t kJoinedMax = 256;
/// Maximum relative difference of the speeds of joined motions, caused by rounding to the pose
/// grid.
constexpr double kSpeedTolerance = 1e-3;

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
