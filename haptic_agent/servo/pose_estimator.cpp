// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/servo/pose_estimator.h"

namespace kerf::agent {
namespace {

std::array<StepTracker, 3> three(double quantum) noexcept {
  return {StepTracker(quantum), StepTracker(quantum), StepTracker(quantum)};
}

Vec3 take_each(std::array<StepTracker, 3>& trackers, Vec3 measured, double dt_s,
               bool is_new) noexcept {
  return {trackers[0].take(measured.x, dt_s, is_new), trackers[1].take(measured.y, dt_s, is_new),
          trackers[2].take(measured.z, dt_s, is_new)};
}

}  // namespace

PoseEstimator::PoseEstimator(double resolution_mm, double resolution_rad) noexcept
    : tip_(three(resolution_mm)), axis_(three(resolution_rad)) {}

PoseEstimator::Pose PoseEstimator::take(const Pose& measured, double dt_s, bool is_new) noexcept {
  const Vec3 tip_mm = take_each(tip_, measured.tip_mm, dt_s, is_new);
  const Vec3 axis = take_each(axis_, measured.axis, dt_s, is_new);
  return {tip_mm, axis == measured.axis ? axis : normalized(axis)};
}

void PoseEstimator::reset() noexcept {
  for (StepTracker& tracker : tip_) tracker.reset();
  for (StepTracker& tracker : axis_) tracker.reset();
}

}  // namespace kerf::agent
