// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "kernel/math/vec3.h"

namespace kerf::agent {

/// Joint angles of one arm, rad: rotation about the vertical, and the elevations of both links
/// above the horizontal. The second elevation is absolute: a parallelogram drives the elbow from
/// the base.
using ArmAngles = std::array<double, 3>;
/// Motor torques, N·mm, in the same order; positive torques increase the angle.
using ArmTorques = std::array<double, 3>;

/// Base position and link lengths of an arm, in device coordinates.
struct ArmShape {
  Vec3 base_mm{};
  double upper_mm = 0;
  double fore_mm = 0;

  bool operator==(const ArmShape&) const = default;
};

/// Forward kinematics: p(q) = base + Rz(q0) [l1 cos q1 + l2 cos q2, 0, l1 sin q1 + l2 sin q2].
Vec3 arm_point(const ArmShape& shape, const ArmAngles& q) noexcept;

/// Returns the columns of dp/dq, mm/rad.
std::array<Vec3, 3> arm_jacobian(const ArmShape& shape, const ArmAngles& q) noexcept;

/// Torques that exert `force_n` at the arm's end: tau = J^T f (virtual work). Needs no inverse, so
/// a stretched arm is no special case.
ArmTorques arm_torques(const ArmShape& shape, const ArmAngles& q, Vec3 force_n) noexcept;

}  // namespace kerf::agent
