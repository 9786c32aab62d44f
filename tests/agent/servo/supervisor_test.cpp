// SPDX-License-Identifier: Apache-2.0
#include <limits>

#include "tests/agent/servo/supervisor_rig.h"

namespace kerf::agent::supervisor_test {
namespace {

TEST_F(SupervisorTest, OnlyTheSessionsForcePreventsArmingNotTheGuides) {
  in.requested.force_n = {3, 0, 0};
  pass(700);
  EXPECT_EQ(supervisor.phase(), ServoPhase::kArmed);
  in.guided = in.requested;
  in.requested.force_n.y = 0.1;
  EXPECT_EQ(pass(700), 1);
  EXPECT_EQ(supervisor.phase(), ServoPhase::kActive);
}

TEST_F(SupervisorTest, ArmsThenRampsToFullForce) {
  EXPECT_EQ(pass(1), 0);
  EXPECT_EQ(supervisor.phase(), ServoPhase::kArmed);
  EXPECT_EQ(pass(50), 0);
  EXPECT_EQ(pass(1), 0) << "the ramp starts at zero";
  EXPECT_EQ(supervisor.phase(), ServoPhase::kRamp);
  EXPECT_NEAR(pass(250), 0.5, 0.01);
  EXPECT_EQ(pass(250), 1);
  EXPECT_EQ(supervisor.phase(), ServoPhase::kActive);
}

TEST_F(SupervisorTest, DoesNotArmWithoutDeadmanServerOrDevice) {
  in.deadman = false;
  expect_ready(1000);
  in.deadman = true;
  in.has_answer = false;
  expect_ready(1000);
  in.has_answer = true;
  in.present = false;
  expect_ready(1000);
}

TEST_F(SupervisorTest, LosingDeadmanOrDeviceWhileArmedDisarms) {
  for (bool SafetyInput::* lost : {&SafetyInput::deadman, &SafetyInput::present}) {
    pass(30);
    ASSERT_EQ(supervisor.phase(), ServoPhase::kArmed);
    in.*lost = false;
    expect_ready(100);
    in.*lost = true;
  }
}

TEST_F(SupervisorTest, DoesNotRampWhileForceOrSpeedIsHigh) {
  in.requested.force_n = {0, 0, 0.3};
  pass(1000);
  EXPECT_EQ(supervisor.phase(), ServoPhase::kArmed);
  in.requested = {};
  in.tip_mm_per_s = 60;
  pass(1000);
  EXPECT_EQ(supervisor.phase(), ServoPhase::kArmed);
  in.tip_mm_per_s = 10;
  arm();
}

TEST_F(SupervisorTest, ReleasingTheDeadmanEndsTheForceInTheSameTick) {
  arm();
  in.deadman = false;
  EXPECT_EQ(pass(1), 0);
  EXPECT_EQ(supervisor.phase(), ServoPhase::kReady);
  EXPECT_EQ(supervisor.trips(), 0U);
  in.deadman = true;
  EXPECT_EQ(pass(50), 0);
  EXPECT_LT(pass(100), 0.5) << "and ramps again";
}

TEST_F(SupervisorTest, TripsOnEachLimit) {
  struct Case {
    TripCode code;
    void (*spoil)(SafetyInput&);
  };
  const Case cases[] = {
      {TripCode::kDeviceLost, [](SafetyInput& i) { i.present = false; }},
      {TripCode::kNotFinite, [](SafetyInput& i) { i.finite = false; }},
      {TripCode::kWorkspace, [](SafetyInput& i) { i.tip_mm = {0, 101, 0}; }},
      {TripCode::kJump, [](SafetyInput& i) { i.jumped_mm = 5.1; }},
      {TripCode::kSpeed, [](SafetyInput& i) { i.tip_mm_per_s = 1001; }},
      {TripCode::kTurnSpeed, [](SafetyInput& i) { i.turn_rad_per_s = 15.1; }},
      {TripCode::kLostTicksInARow, [](SafetyInput& i) { i.lost_now = 5; }},
      {TripCode::kOverdrawn, [](SafetyInput& i) { i.overdrawn = true; }},
      {TripCode::kRejectedWrench,
       [](SafetyInput& i) { i.requested.force_n.x = std::numeric_limits<double>::quiet_NaN(); }},
  };
  for (const Case& c : cases) {
    SCOPED_TRACE(to_string(c.code));
    supervisor = Supervisor(limits);
    in = SafetyInput{.now_us = 1'000'000, .deadman = true, .has_answer = true};
    arm();
    c.spoil(in);
    expect_trip(c.code);
  }
}

TEST_F(SupervisorTest, TripsOnSustainedForceNotOnAPeak) {
  arm();
  in.output.force_n = {6, 0, 0};
  EXPECT_GT(pass(1000), 0) << "one second at three times the rating is permitted";
  in.output.force_n = {3, 0, 0};
  pass(10'000);
  EXPECT_EQ(supervisor.code(), TripCode::kThermalForce);
}

TEST_F(SupervisorTest, TripsOnSustainedTorque) {
  arm();
  in.output.torque_nmm = {0, 150, 0};
  pass(10'000);
  EXPECT_EQ(supervisor.code(), TripCode::kThermalTorque);
}

TEST_F(SupervisorTest, StaysSafeUntilTheDeadmanIsReleased) {
  arm();
  in.tip_mm_per_s = 2000;
  expect_trip(TripCode::kSpeed);
  in.tip_mm_per_s = 0;
  EXPECT_EQ(pass(5000), 0);
  EXPECT_EQ(supervisor.phase(), ServoPhase::kSafe);
  in.deadman = false;
  pass(290);
  EXPECT_EQ(supervisor.phase(), ServoPhase::kSafe) << "a short release does not count";
  pass(11);
  EXPECT_EQ(supervisor.phase(), ServoPhase::kReady);
  in.deadman = true;
  arm();
}

TEST_F(SupervisorTest, LostTicksTripOnlyOnce) {
  arm();
  in.lost_now = 600;  // 60 % of a second at once
  expect_trip(TripCode::kLostTicksInARow);
  in.lost_now = 0;
  in.deadman = false;
  pass(310);
  in.deadman = true;
  arm();
  EXPECT_EQ(supervisor.trips(), 1U);
}

TEST_F(SupervisorTest, ReleasingTheCuttingButtonRearmsWithoutADeadman) {
  limits.has_deadman = false;
  supervisor = Supervisor(limits);
  in.cutting = true;
  arm();
  in.lost_now = 5;
  expect_trip(TripCode::kLostTicksInARow);
  in.lost_now = 0;
  EXPECT_EQ(pass(5000), 0);
  in.cutting = false;
  pass(290);
  EXPECT_EQ(supervisor.phase(), ServoPhase::kSafe) << "a short release does not count";
  pass(11);
  EXPECT_EQ(supervisor.phase(), ServoPhase::kReady);
  arm();
}

TEST_F(SupervisorTest, TripWhileNotCuttingRequiresAPressToRearm) {
  limits.has_deadman = false;
  supervisor = Supervisor(limits);
  arm();
  in.lost_now = 5;
  expect_trip(TripCode::kLostTicksInARow);
  in.lost_now = 0;
  pass(5000);
  EXPECT_EQ(supervisor.phase(), ServoPhase::kSafe);
  in.cutting = true;
  pass(20);
  in.cutting = false;
  pass(301);
  EXPECT_EQ(supervisor.phase(), ServoPhase::kReady);
}

TEST_F(SupervisorTest, ReleasingTheCuttingButtonDoesNotRearmWithADeadman) {
  in.cutting = true;
  arm();
  in.lost_now = 5;
  expect_trip(TripCode::kLostTicksInARow);
  in.lost_now = 0;
  in.cutting = false;
  pass(5000);
  EXPECT_EQ(supervisor.phase(), ServoPhase::kSafe);
}

TEST_F(SupervisorTest, DegradesWhileTheServerIsLateAndDisarmsWhenItIsLost) {
  arm();
  in.answer_age_us = 30 * kMs;
  EXPECT_EQ(pass(10), 1) << "fading happens elsewhere";
  EXPECT_EQ(supervisor.phase(), ServoPhase::kDegraded);
  in.answer_age_us = 1 * kMs;
  pass(199);
  EXPECT_EQ(supervisor.phase(), ServoPhase::kDegraded);
  pass(10);
  EXPECT_EQ(supervisor.phase(), ServoPhase::kActive);
  in.answer_age_us = 1001 * kMs;
  EXPECT_EQ(pass(1), 0);
  EXPECT_EQ(supervisor.phase(), ServoPhase::kReady);
  in.answer_age_us = 0;
  pass(60);
  EXPECT_EQ(supervisor.phase(), ServoPhase::kRamp) << "ramps up again";
}

TEST_F(SupervisorTest, DegradesAfterTheTankWasEmptyForAWhile) {
  arm();
  in.starving = true;
  pass(100);
  EXPECT_EQ(supervisor.phase(), ServoPhase::kActive);
  pass(10);
  EXPECT_EQ(supervisor.phase(), ServoPhase::kDegraded);
}

TEST(SupervisorWithoutMotors, NeverLimitsAndNeverTrips) {
  Supervisor supervisor({.motors = false});
  EXPECT_EQ(supervisor.tick({.now_us = 5, .jumped_mm = 100, .tip_mm_per_s = 9000}), 1);
  EXPECT_EQ(supervisor.trips(), 0U);
}

}  // namespace
}  // namespace kerf::agent::supervisor_test
