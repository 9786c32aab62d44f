// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "haptic_agent/device/step_tracker.h"
#include "kernel/math/vec3.h"

namespace kerf::agent {

/// Estimates the pose of a device between the steps of its encoders, separately for each coordinate
/// of tip and axis (StepTracker). A tool whose pose is rounded to 0.05 mm moves in one of dozens of
/// ticks, along the axes of the encoders. Without the estimate it would cut a staircase and feel
/// the force of its treads.
class PoseEstimator {
 public:
  struct Pose {
    Vec3 tip_mm{}, axis{0, 0, 1};
  };

  /// Quanta of the tip, mm, and of the axis, rad, or 0 if unknown (StepTracker).
  PoseEstimator(double resolution_mm, double resolution_rad) noexcept;

  /// Adds the pose measured `dt_s` after the last one. Returns the estimate for the present time.
  /// `is_new`: see StepTracker.
  Pose take(const Pose& measured, double dt_s, bool is_new) noexcept;
  void reset() noexcept;

 private:
  std::array<StepTracker, 3> tip_, axis_;
};

}  // namespace kerf::agent
