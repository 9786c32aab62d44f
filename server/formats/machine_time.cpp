// SPDX-License-Identifier: Apache-2.0
#include "server/formats/machine_time.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "kernel/math/rotation.h"
#include "server/formats/number_text.h"

namespace kerf {
namespace {

constexpr double kUnlimited = std::numeric_limits<double>::infinity();

/// Returns the factor that the slowest of three axes permits for a vector: min limit / |part|.
double slowest_axis(Vec3 limit, Vec3 direction) {
  double least = kUnlimited;
  for (const auto axis : {&Vec3::x, &Vec3::y, &Vec3::z}) {
    const double part = std::abs(direction.*axis);
    if (part > 0) least = std::min(least, limit.*axis / part);
  }
  return least;
}

/// Time for a length with these speeds at its ends.
double trapezoid_s(double length, double from, double to, double speed, double acceleration) {
  const double peak =
      std::min(speed, std::sqrt(acceleration * length + (from * from + to * to) / 2));
  const double ramps = (2 * peak * peak - from * from - to * to) / (2 * acceleration);
  return (2 * peak - from - to) / acceleration + std::max(0.0, length - ramps) / peak;
}

}  // namespace

MachineDynamics dynamics_of(const Machine& machine) {
  constexpr double kSPerMin = 60;
  const double rapid = machine.rapid_mm_per_min;
  const Vec3 fastest = machine.feed_max_mm_per_min.value_or(Vec3{rapid, rapid, rapid});
  return {.speed_max_mm_per_s = fastest * (1 / kSPerMin),
          .acceleration_mm_per_s2 = machine.acceleration_mm_per_s2,
          .turn_max_rad_per_s = machine.turn_max_rad_per_s,
          .turn_acceleration_rad_per_s2 = machine.turn_acceleration_rad_per_s2};
}

MachineTime::Block MachineTime::block_of(const ProgramMotion& motion) const {
  const Vec3 travel = motion.to.tip_mm - motion.from.tip_mm;
  const double turn = angle_between(normalized(motion.from.axis), normalized(motion.to.axis));
  const double path = kerf::length(travel);
  Block block;
  block.length = path > 0 ? path : turn;
  if (!(block.length > 0)) return block;
  // A turn takes part of the coordinate. Without travel it is the coordinate.
  const double turn_share = turn / block.length;
  if (path > 0) block.direction = travel * (1 / path);
  const double turns = turn_share > 0 ? 1 / turn_share : kUnlimited;
  block.speed = std::min({block.length / motion.duration_s,
                          slowest_axis(dynamics_.speed_max_mm_per_s, block.direction),
                          dynamics_.turn_max_rad_per_s * turns});
  block.acceleration = std::min(slowest_axis(dynamics_.acceleration_mm_per_s2, block.direction),
                                dynamics_.turn_acceleration_rad_per_s2 * turns);
  return block;
}

/// The speed on an arc between two directions that passes the corner at a distance of corner_mm.
double MachineTime::corner_speed(const Block& from, const Block& to) const {
  const double slower = std::min(from.speed, to.speed);
  const double cosine = dot(from.direction, to.direction);
  const bool travels = kerf::length(from.direction) > 0 && kerf::length(to.direction) > 0;
  constexpr double kStraight = 1 - 1e-9;
  if (!travels) return 0;
  if (cosine >= kStraight) return slower;
  const double half_sine = std::sqrt((1 + cosine) / 2);  // of half the angle between the legs
  const double radius = dynamics_.corner_mm * half_sine / (1 - half_sine);
  return std::min(slower, std::sqrt(std::min(from.acceleration, to.acceleration) * radius));
}

void MachineTime::add(const ProgramMotion& motion) {
  Block block = block_of(motion);
  const double mm_per_s = kerf::length(motion.to.tip_mm - motion.from.tip_mm) / motion.duration_s;
  if (!motion.rapid && mm_per_s > fastest_mm_per_s_) {
    fastest_mm_per_s_ = mm_per_s;
    fastest_line_ = motion.line;
  }
  const bool continues = last_ && last_->to == motion.from && last_->tool == motion.tool;
  last_ = motion;
  const bool is_dwell = !(block.length > 0);
  if (!continues || is_dwell) {
    settle(ahead_.size());
    entered_ = 0;
  }
  if (is_dwell) {
    total_s_ += motion.duration_s;
    return;
  }
  if (!ahead_.empty()) block.entry_max = corner_speed(ahead_.back(), block);
  ahead_.push_back(block);
  if (ahead_.size() >= 2 * MachineDynamics::kLookAhead) settle(MachineDynamics::kLookAhead);
}

/// Speeds at the starts of the first `count` blocks, and after them, such that the machine can stop
/// after the last of all.
std::vector<double> MachineTime::entries(std::size_t count) const {
  std::vector<double> entry(ahead_.size() + 1, 0);
  for (std::size_t i = ahead_.size(); i-- > 1;) {
    const Block& block = ahead_[i];
    const double stops =
        std::sqrt(entry[i + 1] * entry[i + 1] + 2 * block.acceleration * block.length);
    entry[i] = std::min({block.entry_max, block.speed, stops});
  }
  if (!entry.empty()) entry[0] = entered_;
  for (std::size_t i = 0; i < count; ++i) {
    const Block& block = ahead_[i];
    const double reached = std::sqrt(entry[i] * entry[i] + 2 * block.acceleration * block.length);
    entry[i + 1] = std::min(entry[i + 1], reached);
  }
  return entry;
}

double MachineTime::time_of(std::size_t first, std::size_t end,
                            const std::vector<double>& entry) const {
  double seconds = 0;
  for (std::size_t i = first; i < end; ++i) {
    const Block& block = ahead_[i];
    seconds += trapezoid_s(block.length, entry[i], entry[i + 1], block.speed, block.acceleration);
  }
  return seconds;
}

void MachineTime::settle(std::size_t count) {
  if (count == 0) return;
  const std::vector<double> entry = entries(count);
  total_s_ += time_of(0, count, entry);
  entered_ = entry[count];
  ahead_.erase(ahead_.begin(), ahead_.begin() + static_cast<std::ptrdiff_t>(count));
}

double MachineTime::total_s() const {
  return total_s_ + time_of(0, ahead_.size(), entries(ahead_.size()));
}

std::optional<std::string> MachineTime::feed_question(const std::string& program) const {
  const double mm_per_min = fastest_mm_per_s_ * 60;
  if (mm_per_min <= kFeedMaxMmPerMin) return std::nullopt;
  return program + ":" + std::to_string(fastest_line_) + ": a feed of " +
         significant_text(mm_per_min, 3) + " mm/min, and no machine follows more than " +
         significant_text(kFeedMaxMmPerMin, 3) + ": is its unit the one that is meant?";
}

}  // namespace kerf
