// SPDX-License-Identifier: Apache-2.0
#include "tests/usb/model/felt_wrench.h"

namespace kerf::usb_test {

namespace {

/// Returns the force f at the arm's end that these torques balance: each torque is the component of
/// f along the end's displacement per joint angle.
Vec3 end_force(const agent::ArmShape& arm, const agent::ArmAngles& q, const double* torques_nmm) {
  constexpr double kTurn = 1e-6;
  std::array<Vec3, 3> travel{};
  for (std::size_t i = 0; i < 3; ++i) {
    agent::ArmAngles ahead = q, behind = q;
    ahead[i] += kTurn;
    behind[i] -= kTurn;
    travel[i] = (arm_point(arm, ahead) - arm_point(arm, behind)) * (0.5 / kTurn);
  }
  const Vec3 force = cross(travel[1], travel[2]) * torques_nmm[0] +
                     cross(travel[2], travel[0]) * torques_nmm[1] +
                     cross(travel[0], travel[1]) * torques_nmm[2];
  return force * (1.0 / dot(travel[0], cross(travel[1], travel[2])));
}

}  // namespace

Wrench felt_wrench(const agent::PenShape& pen, const agent::PenAngles& q,
                   const std::array<double, 6>& motors_nmm) {
  const Vec3 front_n = end_force(pen.front, q.front, motors_nmm.data());
  const Vec3 rear_n = end_force(pen.rear, q.rear, motors_nmm.data() + 3);
  const Vec3 along = arm_point(pen.rear, q.rear) - arm_point(pen.front, q.front);
  const Vec3 axis = normalized(along);
  return {.force_n = front_n + rear_n,
          .torque_nmm = cross(axis * -pen.grip_mm, front_n) +
                        cross(axis * (pen.length_mm - pen.grip_mm), rear_n)};
}

}  // namespace kerf::usb_test
