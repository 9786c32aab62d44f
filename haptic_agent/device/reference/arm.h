// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "kernel/math/vec3.h"

namespace kerf::agent {

/// Joint angles of one arm, rad: turn about the vertical, and the elevations of both links above
/// the horizontal. The second elevation is absolute: a parallelogram drives the elbow from the
/// base.
using ArmAngles = std::array<double, 3>;
/// Motor torques, N·mm, in the same order; positive where they raise the angle.
using ArmTorques = std::array<double, 3>;

/// Where an arm stands and how long its links are, in the device's coordinates.
struct ArmShape {
  Vec3 base_mm{};
  double upper_mm = 0;
  double fore_mm = 0;

  bool operator==(const ArmShape&) const = default;
};

/// p(q) = base + Rz(q0) [l1 cos q1 + l2 cos q2, 0, l1 sin q1 + l2 sin q2].
Vec3 arm_point(const ArmShape& shape, const ArmAngles& q) noexcept;

/// The columns of dp/dq, mm/rad.
std::array<Vec3, 3> arm_jacobian(const ArmShape& shape, const ArmAngles& q) noexcept;

/// The torques that make the arm's end push with `force_n`: tau = J^T f (virtual work). Needs no
/// inverse, so that a straight arm is no special case.
ArmTorques arm_torques(const ArmShape& shape, const ArmAngles& q, Vec3 force_n) noexcept;

}  // namespace kerf::agent
