// SPDX-License-Identifier: Apache-2.0
#include "server/formats/machine_time.h"

#include "tests/support/test.h"

namespace kerf::machine_time_test {
namespace {

constexpr double kSpeed = 100, kAcceleration = 2000;

MachineDynamics dynamics() {
  return {.speed_max_mm_per_s = {kSpeed, kSpeed, kSpeed},
          .acceleration_mm_per_s2 = {kAcceleration, kAcceleration, kAcceleration},
          .turn_max_rad_per_s = 2,
          .turn_acceleration_rad_per_s2 = 8,
          .corner_mm = 0.01};
}

ProgramMotion motion(Vec3 from, Vec3 to, double mm_per_s) {
  const double travel = length(to - from);
  return {.tool = 1,
          .from = {from, {0, 0, 1}},
          .to = {to, {0, 0, 1}},
          .duration_s = travel > 0 ? travel / mm_per_s : 1};
}

double path_s(std::initializer_list<Vec3> corners, double mm_per_s) {
  MachineTime time(dynamics());
  const Vec3* last = nullptr;
  for (const Vec3& corner : corners) {
    if (last != nullptr) time.add(motion(*last, corner, mm_per_s));
    last = &corner;
  }
  return time.total_s();
}

TEST(MachineTime, AMotionIsAcceleratedAndBraked) {
  EXPECT_NEAR(path_s({{0, 0, 0}, {50, 0, 0}}, 40), 50.0 / 40 + 40 / kAcceleration, 1e-12);
  EXPECT_NEAR(path_s({{0, 0, 0}, {0.1, 0, 0}}, 40), 2 * std::sqrt(0.1 / kAcceleration), 1e-12)
      << "too short to be as fast as programmed";
  EXPECT_NEAR(path_s({{0, 0, 0}, {50, 0, 0}}, 1e9), 50 / kSpeed + kSpeed / kAcceleration, 1e-9)
      << "the axis is slower than the program";
}

TEST(MachineTime, TheSlowestAxisOnADirectionLimitsIt) {
  MachineDynamics slow = dynamics();
  slow.speed_max_mm_per_s.y = 10;
  slow.acceleration_mm_per_s2.y = 100;
  MachineTime time(slow);
  time.add(motion({0, 0, 0}, {30, 40, 0}, 1e9));  // 0.8 of it is along Y
  EXPECT_NEAR(time.total_s(), 50 / 12.5 + 12.5 / 125, 1e-9);
}

TEST(MachineTime, StraightPathsAreOneMotionHoweverDivided) {
  MachineTime whole(dynamics()), divided(dynamics());
  whole.add(motion({0, 0, 0}, {100, 0, 0}, 50));
  constexpr int kParts = 1000;  // far more than the control's look-ahead
  for (int i = 0; i < kParts; ++i) divided.add(motion({0.1 * i, 0, 0}, {0.1 * (i + 1), 0, 0}, 50));
  EXPECT_NEAR(divided.total_s(), whole.total_s(), 1e-6);
}

TEST(MachineTime, TooShortAPathAheadLimitsTheSpeed) {
  // 100 blocks of 0.001 mm are 0.1 mm, in which 20 mm/s can be braked: 200 blocks at most.
  MachineTime time(dynamics());
  for (int i = 0; i < 20'000; ++i)
    time.add(motion({0.001 * i, 0, 0}, {0.001 * (i + 1), 0, 0}, 100));
  EXPECT_GT(time.total_s(), 20 / std::sqrt(2 * kAcceleration * 0.2));
  EXPECT_LT(time.total_s(), 20 / std::sqrt(2 * kAcceleration * 0.1) * 1.1);
}

TEST(MachineTime, ACornerIsPassedAtTheSpeedOfItsArc) {
  const double half = std::sqrt(0.5);
  const double corner = std::sqrt(kAcceleration * 0.01 * half / (1 - half));
  ASSERT_LT(corner, 40);
  // Each leg: from rest to 40 mm/s, at 40, and down to the corner's speed.
  const double ramps_mm = (2 * 40 * 40 - corner * corner) / (2 * kAcceleration);
  const double leg_s = (2 * 40 - corner) / kAcceleration + (30 - ramps_mm) / 40;
  EXPECT_NEAR(path_s({{0, 0, 0}, {30, 0, 0}, {30, 30, 0}}, 40), 2 * leg_s, 1e-9);
  EXPECT_NEAR(path_s({{0, 0, 0}, {30, 0, 0}, {0, 0, 0}}, 40), 2 * (30.0 / 40 + 40 / kAcceleration),
              1e-9)
      << "back along the same line, it stops";
}

TEST(MachineTime, TurnsAreLimitedToo) {
  ProgramMotion turn{.tool = 1, .from = {{0, 0, 0}, {0, 0, 1}}, .to = {{0, 0, 0}, {1, 0, 0}}};
  turn.duration_s = 1e-3;
  MachineTime time(dynamics());
  time.add(turn);
  const double angle = std::acos(0.0);
  EXPECT_NEAR(time.total_s(), angle / 2 + 2.0 / 8, 1e-9);
}

TEST(MachineTime, DwellsCountAndStopTheTool) {
  MachineTime time(dynamics());
  time.add(motion({0, 0, 0}, {50, 0, 0}, 40));
  time.add(motion({50, 0, 0}, {50, 0, 0}, 1));
  time.add(motion({50, 0, 0}, {100, 0, 0}, 40));
  EXPECT_NEAR(time.total_s(), 1 + 2 * (50.0 / 40 + 40 / kAcceleration), 1e-9);
}

TEST(MachineTime, UnreachableFeedIsQuestioned) {
  MachineTime time(dynamics());
  ProgramMotion feed = motion({0, 0, 0}, {50, 0, 0}, 3000);
  feed.line = 12;
  time.add(feed);
  EXPECT_FALSE(time.feed_question("p.ngc"));
  feed.duration_s = 50 / 75'000.0;
  feed.line = 13;
  time.add(feed);
  EXPECT_EQ(time.feed_question("p.ngc"),
            "p.ngc:13: a feed of 4500000 mm/min, and no machine follows more than 200000: is its "
            "unit the one that is meant?");
  feed.rapid = true;
  MachineTime rapids(dynamics());
  rapids.add(feed);
  EXPECT_FALSE(rapids.feed_question("p.ngc")) << "the speed of a rapid is the scene's";
}

TEST(MachineTime, TheMachineOfTheSceneStatesTheLimitsOfItsAxes) {
  Machine machine{.rapid_mm_per_min = 6000};
  EXPECT_EQ(dynamics_of(machine).speed_max_mm_per_s, (Vec3{100, 100, 100}));
  machine.feed_max_mm_per_min = Vec3{6000, 3000, 600};
  machine.acceleration_mm_per_s2 = {2000, 1000, 100};
  machine.turn_max_rad_per_s = 2;
  machine.turn_acceleration_rad_per_s2 = 8;
  const auto time_s = [&](Vec3 to) {
    MachineTime time(dynamics_of(machine));
    time.add(motion({0, 0, 0}, to, 1e6));
    return time.total_s();
  };
  EXPECT_NEAR(time_s({100, 0, 0}), 100.0 / 100 + 100.0 / 2000, 1e-9);
  EXPECT_NEAR(time_s({0, 100, 0}), 100.0 / 50 + 50.0 / 1000, 1e-9);
  EXPECT_NEAR(time_s({0, 0, 100}), 100.0 / 10 + 10.0 / 100, 1e-9);
  EXPECT_EQ(dynamics_of(machine).turn_max_rad_per_s, 2);
  EXPECT_EQ(dynamics_of(machine).turn_acceleration_rad_per_s2, 8);
}

}  // namespace
}  // namespace kerf::machine_time_test
