// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

#include "haptic_agent/device/pose_script.h"

namespace kerf::agent {

/// Position and velocity of a path at one time.
struct PathPoint {
  Vec3 tip_mm{};
  Vec3 axis{0, 0, 1};
  Vec3 tip_mm_per_s{};
  Vec3 turn_rad_per_s{};
  bool cutting = false;
  std::uint32_t tool_id = 0;
  bool at_end = false;
};

/// Interpolates a script: between two poses the tip moves on a straight line and the axis on a
/// great circle, both at constant speed. With `loop` the path repeats, after a non-cutting move
/// from the last pose to the first.
class PathCursor {
 public:
  /// `script` must not be empty. `speed` > 0 scales time: 2 plays twice as fast.
  PathCursor(PoseScript script, bool loop, double speed = 1.0);

  /// Returns the point at `time_s` after the start; `time_s` must not decrease. Does not allocate.
  PathPoint at(double time_s) noexcept;

  double duration_s() const noexcept { return script_.back().time_s - script_.front().time_s; }

 private:
  PathPoint resting(const TimedPose& pose) const noexcept;

  PoseScript script_;
  bool loop_;
  /// Index of the end pose of the segment that contains the last requested time.
  std::size_t next_ = 1;
  double lap_start_s_ = 0;
};

}  // namespace kerf::agent
