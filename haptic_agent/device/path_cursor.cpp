// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/device/path_cursor.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

namespace kerf::agent {
namespace {

/// Below this sine of the angle, the rotation is treated as zero.
constexpr double kStraightSine = 1e-9;
/// Shortest lap that repeats. A shorter script stays at its end.
constexpr double kShortestLapS = 1e-3;

struct Turn {
  Vec3 rate;  // rotation vector, rad
  double angle_rad = 0;
};

Turn turn_between(Vec3 from, Vec3 to) noexcept {
  const Vec3 normal = cross(from, to);
  const double sine = length(normal);
  const double angle = std::atan2(sine, dot(from, to));
  if (sine < kStraightSine) return {};
  return {normal * (angle / sine), angle};
}

Vec3 turned(Vec3 from, const Turn& turn, double part) noexcept {
  if (turn.angle_rad == 0) return from;
  const Vec3 normal = turn.rate * (1.0 / turn.angle_rad);
  const double angle = turn.angle_rad * part;
  return normalized(from * std::cos(angle) + cross(normal, from) * std::sin(angle));
}

}  // namespace

PathCursor::PathCursor(PoseScript script, bool loop, double speed)
    : script_(std::move(script)), loop_(loop) {
  assert(!script_.empty() && speed > 0);
  const double start_s = script_.front().time_s;
  for (TimedPose& pose : script_) pose.time_s = (pose.time_s - start_s) / speed;
  if (!loop_) return;
  TimedPose home = script_.front();
  home.time_s = script_.back().time_s + travel_time_s(script_.back(), home, {});
  home.cutting = false;
  script_.push_back(home);
  loop_ = home.time_s >= kShortestLapS;
}

PathPoint PathCursor::resting(const TimedPose& pose) const noexcept {
  return {.tip_mm = pose.tip_mm,
          .axis = pose.axis,
          .cutting = pose.cutting,
          .tool_id = pose.tool_id,
          .at_end = true};
}

PathPoint PathCursor::at(double time_s) noexcept {
  double local_s = std::max(0.0, time_s - lap_start_s_);
  const double lap_s = script_.back().time_s;
  if (loop_ && local_s >= lap_s) {
    const double laps = std::floor(local_s / lap_s);
    lap_start_s_ += laps * lap_s;
    local_s -= laps * lap_s;
    next_ = 1;
  }
  // A step that leaves a cutting segment cuts, because its first part was in that segment.
  bool cutting = false;
  while (next_ < script_.size() && script_[next_].time_s <= local_s) {
    cutting = cutting || script_[next_].cutting;
    ++next_;
  }
  if (next_ >= script_.size()) return resting(script_.back());
  const TimedPose& from = script_[next_ - 1];
  const TimedPose& to = script_[next_];
  const double span_s = to.time_s - from.time_s;
  const double part = (local_s - from.time_s) / span_s;
  const Turn turn = turn_between(from.axis, to.axis);
  return {.tip_mm = from.tip_mm + (to.tip_mm - from.tip_mm) * part,
          .axis = turned(from.axis, turn, part),
          .tip_mm_per_s = (to.tip_mm - from.tip_mm) * (1.0 / span_s),
          .turn_rad_per_s = turn.rate * (1.0 / span_s),
          .cutting = cutting || to.cutting,
          .tool_id = to.tool_id};
}

}  // namespace kerf::agent
