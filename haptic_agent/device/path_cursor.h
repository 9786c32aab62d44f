// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

#include "haptic_agent/device/pose_script.h"

namespace kerf::agent {

/// Where a path is at one time, and how fast.
struct PathPoint {
  Vec3 tip_mm{};
  Vec3 axis{0, 0, 1};
  Vec3 tip_mm_per_s{};
  Vec3 turn_rad_per_s{};
  bool cutting = false;
  std::uint32_t tool_id = 0;
  bool at_end = false;
};

/// Walks a script: between two poses the tip moves straight and the axis turns on the great circle,
/// both uniformly. With `loop` the path starts over for ever, after a way through the air from the
/// last pose to the first.
class PathCursor {
 public:
  /// `script` is not empty. `speed` stretches time: 2 plays twice as fast.
  PathCursor(PoseScript script, bool loop, double speed = 1.0);

  /// The point `time_s` after the start; `time_s` must not go back. No allocation.
  PathPoint at(double time_s) noexcept;

  double duration_s() const noexcept { return script_.back().time_s - script_.front().time_s; }

 private:
  PathPoint resting(const TimedPose& pose) const noexcept;

  PoseScript script_;
  bool loop_;
  /// Index of the pose at the end of the segment that holds the last time asked for.
  std::size_t next_ = 1;
  double lap_start_s_ = 0;
};

}  // namespace kerf::agent
