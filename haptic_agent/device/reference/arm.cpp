// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/device/reference/arm.h"

#include <cmath>

namespace kerf::agent {

Vec3 arm_point(const ArmShape& shape, const ArmAngles& q) noexcept {
  const double reach = shape.upper_mm * std::cos(q[1]) + shape.fore_mm * std::cos(q[2]);
  const double rise = shape.upper_mm * std::sin(q[1]) + shape.fore_mm * std::sin(q[2]);
  return shape.base_mm + Vec3{reach * std::cos(q[0]), reach * std::sin(q[0]), rise};
}

std::array<Vec3, 3> arm_jacobian(const ArmShape& shape, const ArmAngles& q) noexcept {
  const Vec3 out{std::cos(q[0]), std::sin(q[0]), 0};
  const Vec3 around{-out.y, out.x, 0};
  const Vec3 up{0, 0, 1};
  const double reach = shape.upper_mm * std::cos(q[1]) + shape.fore_mm * std::cos(q[2]);
  const auto link = [&](double length_mm, double angle) {
    return (up * std::cos(angle) - out * std::sin(angle)) * length_mm;
  };
  return {around * reach, link(shape.upper_mm, q[1]), link(shape.fore_mm, q[2])};
}

ArmTorques arm_torques(const ArmShape& shape, const ArmAngles& q, Vec3 force_n) noexcept {
  const auto j = arm_jacobian(shape, q);
  return {dot(j[0], force_n), dot(j[1], force_n), dot(j[2], force_n)};
}

}  // namespace kerf::agent
