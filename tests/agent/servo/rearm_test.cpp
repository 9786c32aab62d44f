// SPDX-License-Identifier: Apache-2.0
// How the user of a device without a deadman re-arms it after a trip.
#include <cmath>
#include <limits>

#include "tests/agent/servo/supervisor_rig.h"

namespace kerf::agent::rearm_test {
namespace {

class RearmTest : public SupervisorTest {
 protected:
  RearmTest() { limits.has_deadman = false; }

  void trip() {
    supervisor = Supervisor(limits);
    arm();
    in.lost_now = 5;
    expect_trip(TripCode::kLostTicksInARow);
    in.lost_now = 0;
  }
  /// Moves to a point within `ms`, in equal steps, rounded to the quantum.
  void move(Vec3 to_mm, int ms) {
    const Vec3 from_mm = at_mm;
    for (int i = 1; i <= ms; ++i) {
      at_mm = from_mm + (to_mm - from_mm) * (static_cast<double>(i) / ms);
      const Vec3 before_mm = in.tip_mm;
      in.tip_mm = rounded(at_mm);
      in.jumped_mm = length(in.tip_mm - before_mm);
      pass(1);
    }
    in.jumped_mm = 0;
  }
  /// Holds the tip for `ms` with a tremor of 0.5 mm at 9 Hz.
  void hold(int ms) {
    constexpr double kTremorMm = 0.5, kRadPerMs = 0.0565;
    for (int i = 0; i < ms; ++i) {
      in.tip_mm = rounded(at_mm + Vec3{kTremorMm * std::sin(kRadPerMs * i), 0, 0});
      pass(1);
    }
  }
  Vec3 rounded(Vec3 p) const {
    const auto round = [this](double v) { return std::round(v / quantum_mm) * quantum_mm; };
    return {round(p.x), round(p.y), round(p.z)};
  }
  bool is_safe() const { return supervisor.phase() == ServoPhase::kSafe; }

  double quantum_mm = 0.055;
  Vec3 at_mm{};
};

TEST_F(RearmTest, GestureRearmsWithoutAButton) {
  for (const double quantum : {1e-6, 0.01, 0.055}) {
    quantum_mm = quantum;
    at_mm = in.tip_mm = {};
    trip();
    move({30, 0, 0}, 300);
    hold(1100);
    move({30, 0, 12}, 200);
    EXPECT_TRUE(is_safe());
    move({30, 0, 0}, 200);
    EXPECT_FALSE(is_safe()) << quantum;
    arm();
  }
}

TEST_F(RearmTest, RestStrokesAndDropsDoNotRearm) {
  trip();
  for (int stroke = 0; stroke < 20; ++stroke) {
    move({20, 0, 0}, 400);
    hold(500);
    move({0, 0, 0}, 400);
    hold(500);
  }
  EXPECT_TRUE(is_safe()) << "strokes with pauses of half a second";
  hold(20'000);
  EXPECT_TRUE(is_safe()) << "rest";
  move({0, 0, -60}, 200);
  hold(5000);
  EXPECT_TRUE(is_safe()) << "a drop, and rest";
  move({0, 0, -54}, 100);
  move({0, 0, -60}, 100);
  EXPECT_TRUE(is_safe()) << "6 mm are no gesture";
  hold(3500);
  move({0, 0, -45}, 1500);
  move({0, 0, -60}, 1500);
  EXPECT_TRUE(is_safe()) << "3 s are too slow";
}

TEST_F(RearmTest, GestureCountsOnlyWithoutAComputedForce) {
  trip();
  const auto gesture = [&] {
    const Vec3 place_mm = at_mm;
    hold(1100);
    move(place_mm + Vec3{12, 0, 0}, 200);
    move(place_mm, 200);
  };
  in.requested.force_n = {0, 0, 2};
  gesture();
  EXPECT_TRUE(is_safe()) << "pressed into the stock";
  in.requested.force_n.z = std::numeric_limits<double>::quiet_NaN();
  gesture();
  EXPECT_TRUE(is_safe()) << "a force that is no number";
  in.requested = {};
  in.present = false;
  gesture();
  EXPECT_TRUE(is_safe()) << "absent";
  in.present = true;
  at_mm = {0, 0, 200};
  gesture();
  EXPECT_TRUE(is_safe()) << "outside of the workspace";
  at_mm = {};
  in.cutting = true;
  gesture();
  EXPECT_TRUE(is_safe()) << "with the cutting button pressed";
  in.cutting = false;
  pass(301);
  EXPECT_FALSE(is_safe()) << "but its release counts";
}

TEST_F(RearmTest, PoseJumpRestartsTheGesture) {
  trip();
  hold(1100);
  in.tip_mm = {12, 0, 0};
  in.jumped_mm = 12;
  pass(1);
  in.tip_mm = {};
  pass(1);
  in.jumped_mm = 0;
  pass(1);
  EXPECT_TRUE(is_safe());
}

TEST_F(RearmTest, DeadmanDisablesTheGesture) {
  limits.has_deadman = true;
  trip();
  hold(1100);
  move({12, 0, 0}, 200);
  move({}, 200);
  EXPECT_TRUE(is_safe());
}

TEST_F(RearmTest, RequestRearmsOncePresentAndHasNoOtherEffect) {
  for (const bool deadman : {false, true}) {
    limits.has_deadman = deadman;
    supervisor = Supervisor(limits);
    supervisor.rearm();
    trip();
    pass(1000);
    EXPECT_TRUE(is_safe()) << "asked before the trip";
    in.present = false;
    supervisor.rearm();
    pass(100);
    EXPECT_TRUE(is_safe());
    in.present = true;
    EXPECT_EQ(pass(1), 0);
    EXPECT_EQ(supervisor.phase(), ServoPhase::kReady);
    EXPECT_EQ(pass(40), 0) << "it arms as ever";
    arm();
    supervisor.rearm();
    EXPECT_EQ(pass(10), 1);
  }
}

TEST_F(RearmTest, DeviceOutsideItsWorkspaceDoesNotArm) {
  in.tip_mm = {0, 101, 0};
  expect_ready(1000);
  EXPECT_EQ(supervisor.no_force(), NoForce::kOutOfReach);
  in.tip_mm = {};
  arm();
  EXPECT_EQ(supervisor.trips(), 0U);
}

}  // namespace
}  // namespace kerf::agent::rearm_test
