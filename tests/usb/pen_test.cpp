// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/device/reference/pen.h"

#include "tests/support/test.h"
#include "tests/usb/model/reference_firmware.h"

namespace kerf::agent::pen_test {
namespace {

using usb_test::reach_for;

/// Random poses in the specified workspace of the standard pen.
class Poses {
 public:
  struct Pose {
    Vec3 grip_mm;
    Vec3 axis;
    PenAngles q;
  };
  Pose next() {
    const Vec3 grip{kGripReachMm.x * unit_(engine_), kGripReachMm.y * unit_(engine_),
                    pen.grip_mm + kGripReachMm.z * unit_(engine_)};
    const double lean = kLeanRad * std::abs(unit_(engine_)), turn = 3.2 * unit_(engine_);
    const Vec3 axis{std::sin(lean) * std::cos(turn), std::sin(lean) * std::sin(turn),
                    std::cos(lean)};
    return {grip, axis,
            PenAngles{reach_for(pen.front, grip - axis * pen.grip_mm),
                      reach_for(pen.rear, grip + axis * (pen.length_mm - pen.grip_mm))}};
  }
  Vec3 vector(double size) {
    const double x = unit_(engine_), y = unit_(engine_);
    return Vec3{x, y, unit_(engine_)} * size;
  }
  const PenShape pen = standard_pen();

 private:
  std::mt19937 engine_{5};
  std::uniform_real_distribution<double> unit_{-1, 1};
};

constexpr int kPoses = 2000;

TEST(ReferencePen, ForwardInvertsInverse) {
  Poses poses;
  for (int i = 0; i < kPoses; ++i) {
    const auto is = poses.next();
    const auto pose = test::value_of(pen_pose(poses.pen, is.q));
    ASSERT_LT(length(pose.grip_mm - is.grip_mm), 1e-9);
    ASSERT_LT(length(pose.axis - is.axis), 1e-9);
    ASSERT_NEAR(pose.mismatch_mm, 0, 1e-9);
  }
}

TEST(ReferencePen, JacobianMatchesFiniteDifferences) {
  Poses poses;
  constexpr double kStep = 1e-6;
  for (int i = 0; i < kPoses; ++i) {
    const auto is = poses.next();
    const auto columns = arm_jacobian(poses.pen.front, is.q.front);
    for (std::size_t j = 0; j < 3; ++j) {
      ArmAngles less = is.q.front, more = is.q.front;
      less[j] -= kStep;
      more[j] += kStep;
      const Vec3 difference =
          (arm_point(poses.pen.front, more) - arm_point(poses.pen.front, less)) * (0.5 / kStep);
      ASSERT_LT(length(columns[j] - difference), 1e-4);
    }
  }
}

TEST(ReferencePen, PointVelocitiesMatchFiniteDifferences) {
  Poses poses;
  constexpr double kStepS = 1e-6;
  for (int i = 0; i < kPoses; ++i) {
    const auto is = poses.next();
    const Vec3 velocity = poses.vector(100), turn = poses.vector(3);
    const auto points = point_velocities(poses.pen, is.axis, velocity, turn);
    const auto moved = [&](double along_mm) {
      const Vec3 axis = normalized(is.axis + cross(turn, is.axis) * kStepS);
      return (velocity * kStepS + (axis - is.axis) * along_mm) * (1 / kStepS);
    };
    const double above_mm = poses.pen.length_mm - poses.pen.grip_mm;
    ASSERT_LT(length(points.front_mm_per_s - moved(-poses.pen.grip_mm)), 1e-2);
    ASSERT_LT(length(points.rear_mm_per_s - moved(above_mm)), 1e-2);
  }
}

TEST(ReferencePen, ArmForcesDoTheWorkOfTheWrench) {
  Poses poses;
  for (int i = 0; i < kPoses; ++i) {
    const auto is = poses.next();
    const Wrench wrench{.force_n = poses.vector(8), .torque_nmm = poses.vector(150)};
    const Vec3 velocity = poses.vector(200), turn = poses.vector(10);
    const auto forces = distribute(poses.pen, is.axis, wrench);
    const auto points = point_velocities(poses.pen, is.axis, velocity, turn);
    const double by_arms =
        dot(forces.front_n, points.front_mm_per_s) + dot(forces.rear_n, points.rear_mm_per_s);
    // Except for the torque about the pen, which two points on it cannot produce.
    const double about = dot(turn, is.axis);
    const double by_wrench =
        dot(wrench.force_n, velocity) + dot(wrench.torque_nmm, turn) - forces.left_out_nmm * about;
    ASSERT_NEAR(by_arms, by_wrench, 1e-8);
    ASSERT_NEAR(forces.left_out_nmm, dot(wrench.torque_nmm, is.axis), 1e-9);
  }
}

TEST(ReferencePen, TorquesDoTheWorkOfTheForces) {
  Poses poses;
  constexpr double kStepS = 1e-6;
  for (int i = 0; i < kPoses; ++i) {
    const auto is = poses.next();
    const Wrench wrench{.force_n = poses.vector(8), .torque_nmm = poses.vector(150)};
    const Vec3 velocity = poses.vector(50), turn = poses.vector(1);
    const auto forces = distribute(poses.pen, is.axis, wrench);
    const auto torques = pen_torques(poses.pen, is.q, forces);
    // The joint angles after a small motion.
    const Vec3 grip = is.grip_mm + velocity * kStepS;
    const Vec3 axis = normalized(is.axis + cross(turn, is.axis) * kStepS);
    const auto front = reach_for(poses.pen.front, grip - axis * poses.pen.grip_mm);
    const auto rear =
        reach_for(poses.pen.rear, grip + axis * (poses.pen.length_mm - poses.pen.grip_mm));
    double by_motors = 0;
    for (std::size_t j = 0; j < 3; ++j) {
      by_motors += torques[j] * (front[j] - is.q.front[j]) / kStepS;
      by_motors += torques[j + 3] * (rear[j] - is.q.rear[j]) / kStepS;
    }
    const Vec3 across = turn - is.axis * dot(turn, is.axis);
    const double by_wrench = dot(wrench.force_n, velocity) + dot(wrench.torque_nmm, across);
    ASSERT_NEAR(by_motors, by_wrench, 0.05);
  }
}

TEST(ReferencePen, DistributionHasLeastNorm) {
  Poses poses;
  for (int i = 0; i < kPoses; ++i) {
    const auto is = poses.next();
    const Wrench wrench{.force_n = poses.vector(8), .torque_nmm = poses.vector(150)};
    const auto forces = distribute(poses.pen, is.axis, wrench);
    // Only a pair that pulls the pen apart can be added without changing the wrench.
    ASSERT_NEAR(dot(forces.front_n - forces.rear_n, is.axis), 0, 1e-9);
    ASSERT_LT(length(forces.front_n + forces.rear_n - wrench.force_n), 1e-9);
  }
}

TEST(ReferencePen, ImpossibleAnglesHaveNoPose) {
  const PenShape pen = standard_pen();
  PenAngles q{reach_for(pen.front, {0, 0, 0}), reach_for(pen.rear, {0, 0, 80})};
  q.rear[1] = std::nan("");
  EXPECT_FALSE(pen_pose(pen, q));
  q.rear = reach_for(pen.rear, {0, 0, 0});
  EXPECT_FALSE(pen_pose(pen, q));
  q.rear = reach_for(pen.rear, {0, 0, 90});
  ASSERT_TRUE(pen_pose(pen, q));
  EXPECT_NEAR(pen_pose(pen, q)->mismatch_mm, 10, 1e-9);
}

TEST(ReferencePen, TorquesAreScaledByOneFactor) {
  const std::array<double, 6> most = {1500, 1500, 1500, 1500, 1500, 1500};
  const auto wire = reference::wire_torques({3000, -1500, 0, 300, 0, -3000}, most);
  EXPECT_EQ(wire, (std::array<std::int16_t, 6>{15000, -7500, 0, 1500, 0, -15000}));
  // Limits above the field's range must not reverse a sign.
  const std::array<double, 6> huge = {6000, 6000, 6000, 6000, 6000, 6000};
  const auto full = reference::wire_torques({6000, 0, 0, -6000, 0, 0}, huge);
  EXPECT_EQ(full[0], 32767);
  EXPECT_EQ(full[3], -32767);
  EXPECT_EQ(reference::wire_torques({std::nan(""), 10, 0, 0, 0, 0}, most),
            (std::array<std::int16_t, 6>{}));
}

}  // namespace
}  // namespace kerf::agent::pen_test
