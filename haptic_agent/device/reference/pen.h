// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>

#include "haptic_agent/device/haptic_device.h"
#include "haptic_agent/device/reference/arm.h"
#include "haptic_agent/device/step_tracker.h"

namespace kerf::agent {

/// Two arms that hold a pen, each by a ball joint: the front arm at the pen's lower point A, the
/// rear arm at its upper point B (Zhu & Lee 2004, section 4: a left and a right manipulator).
struct PenShape {
  ArmShape front{};
  ArmShape rear{};
  /// |B - A|, L.
  double length_mm = 0;
  /// Distance from A along the pen to the grip point G, where the user holds it: a.
  double grip_mm = 0;

  bool operator==(const PenShape&) const = default;
};

/// Dimensions of the standard device of README.md. The pen reaches every grip point within
/// kGripReachMm of the center, tilted by up to kLeanRad.
PenShape standard_pen() noexcept;
inline constexpr Vec3 kGripReachMm{60, 50, 50};
inline constexpr double kLeanRad = 0.87;

struct PenAngles {
  ArmAngles front{};
  ArmAngles rear{};
};

/// Estimates the joints' angles between encoder steps, whose size it finds from the angles because
/// the device does not state it. The coordinates of the pen have no steps of their own.
class JointTracker {
 public:
  /// Adds the angles measured `dt_s` after the last ones. Returns the estimated angles.
  PenAngles take(const PenAngles& measured, double dt_s) noexcept;
  void reset() noexcept;

 private:
  std::array<StepTracker, 6> joints_;
};

/// A pose of 5 DOF: two points do not determine the rotation about their common line.
struct PenPose {
  Vec3 grip_mm{};
  /// Unit, u = (B - A)/|B - A|: from the tool's tip towards the spindle.
  Vec3 axis{0, 0, 1};
  /// |B - A| minus the pen's length: the inconsistency of the encoders.
  double mismatch_mm = 0;
};

/// Forward kinematics. Returns nullopt if an angle is not finite or both points coincide.
std::optional<PenPose> pen_pose(const PenShape& shape, const PenAngles& q) noexcept;

/// Velocities of A and B for a velocity of the grip point and an angular velocity of the pen about
/// it (rad/s; its component along the pen has no effect).
struct PointVelocities {
  Vec3 front_mm_per_s{};
  Vec3 rear_mm_per_s{};
};
PointVelocities point_velocities(const PenShape& shape, Vec3 axis, Vec3 velocity_mm_per_s,
                                 Vec3 turn_rad_per_s) noexcept;

/// Forces of both arms at A and B.
struct PointForces {
  Vec3 front_n{};
  Vec3 rear_n{};
  /// The torque about the pen's axis, N·mm. Forces at two points of that axis cannot produce it.
  double left_out_nmm = 0;
};

/// Distributes a force at, and a torque about, the grip point to A and B: the two forces of least
/// norm that do the same work as the wrench in every motion of the pen. With a = |G - A|, L, and m
/// = T x u: across the pen f_B = (a F + m)/L and f_A = F - f_B are the only solution; along it each
/// arm takes half.
PointForces distribute(const PenShape& shape, Vec3 axis, const Wrench& wrench) noexcept;

/// Motor torques, front arm first: J^T f of each arm.
std::array<double, 6> pen_torques(const PenShape& shape, const PenAngles& q,
                                  const PointForces& forces) noexcept;

}  // namespace kerf::agent
