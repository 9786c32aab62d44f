// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/device/reference/pen.h"

#include <algorithm>
#include <cmath>

namespace kerf::agent {
namespace {

/// Below this distance between A and B the pen's direction is undefined.
constexpr double kMinPointDistanceMm = 1.0;

bool all_finite(const ArmAngles& q) noexcept {
  return std::ranges::all_of(q, [](double angle) { return std::isfinite(angle); });
}

}  // namespace

PenShape standard_pen() noexcept {
  return {.front = {.base_mm = {-90, 140, 0}, .upper_mm = 160, .fore_mm = 160},
          .rear = {.base_mm = {90, 140, 80}, .upper_mm = 160, .fore_mm = 160},
          .length_mm = 80,
          .grip_mm = 40};
}

PenAngles JointTracker::take(const PenAngles& measured, double dt_s) noexcept {
  PenAngles angles;
  for (std::size_t i = 0; i < measured.front.size(); ++i) {
    angles.front[i] = joints_[i].take(measured.front[i], dt_s);
    angles.rear[i] = joints_[i + measured.front.size()].take(measured.rear[i], dt_s);
  }
  return angles;
}

void JointTracker::reset() noexcept {
  for (StepTracker& joint : joints_) joint.reset();
}

std::optional<PenPose> pen_pose(const PenShape& shape, const PenAngles& q) noexcept {
  if (!all_finite(q.front) || !all_finite(q.rear)) return std::nullopt;
  const Vec3 a_mm = arm_point(shape.front, q.front);
  const Vec3 between_mm = arm_point(shape.rear, q.rear) - a_mm;
  const double distance_mm = length(between_mm);
  if (!(distance_mm >= kMinPointDistanceMm)) return std::nullopt;
  const Vec3 axis = between_mm * (1.0 / distance_mm);
  return PenPose{.grip_mm = a_mm + axis * shape.grip_mm,
                 .axis = axis,
                 .mismatch_mm = distance_mm - shape.length_mm};
}

PointVelocities point_velocities(const PenShape& shape, Vec3 axis, Vec3 velocity_mm_per_s,
                                 Vec3 turn_rad_per_s) noexcept {
  const Vec3 swing = cross(turn_rad_per_s, axis);
  return {.front_mm_per_s = velocity_mm_per_s - swing * shape.grip_mm,
          .rear_mm_per_s = velocity_mm_per_s + swing * (shape.length_mm - shape.grip_mm)};
}

PointForces distribute(const PenShape& shape, Vec3 axis, const Wrench& wrench) noexcept {
  const double along_n = dot(wrench.force_n, axis);
  const Vec3 across_n = wrench.force_n - axis * along_n;
  // T x u contains no component of the torque along u.
  const Vec3 moment = cross(wrench.torque_nmm, axis);
  const Vec3 rear_n = (across_n * shape.grip_mm + moment) * (1.0 / shape.length_mm);
  const Vec3 half_n = axis * (along_n / 2);
  return {.front_n = across_n - rear_n + half_n,
          .rear_n = rear_n + half_n,
          .left_out_nmm = dot(wrench.torque_nmm, axis)};
}

std::array<double, 6> pen_torques(const PenShape& shape, const PenAngles& q,
                                  const PointForces& forces) noexcept {
  const ArmTorques front = arm_torques(shape.front, q.front, forces.front_n);
  const ArmTorques rear = arm_torques(shape.rear, q.rear, forces.rear_n);
  return {front[0], front[1], front[2], rear[0], rear[1], rear[2]};
}

}  // namespace kerf::agent
