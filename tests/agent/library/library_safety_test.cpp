// SPDX-License-Identifier: Apache-2.0
// The conditions under which libkerf_agent.so returns no force.
#include <limits>

#include "tests/agent/library/library_rig.h"

namespace kerf::agent::library_safety_test {
namespace {

TEST_F(LibraryTest, DeviceWithADeadmanSensorFeelsNothingUntilHeld) {
  serve();
  device_.flags = KERF_AGENT_HAS_DEADMAN;
  connect();
  int ticks = 0;
  double most = 0;
  ASSERT_TRUE(tick_until(pose_at(-kPressedMm), [&] {
    most = std::max(most, norm(wrench_.force_n));
    return ++ticks > 900;
  }));
  EXPECT_EQ(most, 0);
  EXPECT_TRUE(feel(KERF_AGENT_DEADMAN));
}

TEST_F(LibraryTest, TripsOnAnInvalidPoseUntilRearmed) {
  serve();
  connect();
  ASSERT_TRUE(feel());
  EXPECT_EQ(tick(pose_at(std::numeric_limits<double>::infinity())), KERF_AGENT_INVALID);
  EXPECT_EQ(norm(wrench_.force_n), 0);
  const kerf_agent_status tripped = status();
  EXPECT_EQ(tripped.tripped, 1U);
  EXPECT_EQ(tripped.phase, std::uint32_t{KERF_AGENT_PHASE_SAFE});
  EXPECT_STREQ(tripped.phase_text, "safe");
  EXPECT_STREQ(tripped.trip_text, "pose_not_finite");

  // There is no force until the user re-arms.
  int ticks = 0;
  ASSERT_TRUE(tick_until(pose_at(0), [&] { return ++ticks > 700; }));
  EXPECT_EQ(status().tripped, 1U);
  EXPECT_EQ(norm(wrench_.force_n), 0);
  EXPECT_EQ(kerf_agent_rearm(agent_), KERF_AGENT_OK);
  EXPECT_TRUE(feel());
}

TEST_F(LibraryTest, CallsWithinHalfAMillisecondAreOneTick) {
  serve();
  connect();
  const kerf_agent_pose pose = pose_at(5);
  constexpr std::uint64_t kShortUs = 100;
  for (int i = 0; i < 1000; ++i) {
    SteppedClock::advance_us(kShortUs);
    ASSERT_EQ(step(pose), KERF_AGENT_OK);
  }
  EXPECT_EQ(status().ticks, 1000 * kShortUs / 500);
}

TEST_F(LibraryTest, AbsentDeviceGetsNoForceWithinHalfAMillisecondToo) {
  serve();
  connect();
  ASSERT_TRUE(feel());
  EXPECT_EQ(step(sized<kerf_agent_pose>()), KERF_AGENT_OK);
  EXPECT_EQ(norm(wrench_.force_n), 0);
}

TEST_F(LibraryTest, MalformedPoseTripsWithinHalfAMillisecondToo) {
  serve();
  connect();
  ASSERT_TRUE(feel());
  EXPECT_EQ(step(pose_at(std::numeric_limits<double>::infinity())), KERF_AGENT_INVALID);
  EXPECT_EQ(norm(wrench_.force_n), 0);
  EXPECT_STREQ(status().trip_text, "pose_not_finite");
}

TEST_F(LibraryTest, LostConnectionGivesNoForceFromTheFirstResultOn) {
  serve();
  kerf_agent_options given = options();
  given.patience_s = 0.01;
  ASSERT_EQ(kerf_agent_connect(&given, &agent_), KERF_AGENT_OK) << kerf_agent_last_error();
  ASSERT_TRUE(feel());
  std::thread crash([this] { server_.reset(); });
  // The repeated wrench of the newest tick ends too.
  kerf_agent_result result = KERF_AGENT_OK;
  while ((result = tick(pose_at(-kPressedMm))) == KERF_AGENT_OK) {
  }
  EXPECT_EQ(result, KERF_AGENT_LOST);
  EXPECT_EQ(norm(wrench_.force_n), 0);
  crash.join();
}

TEST_F(LibraryTest, RearmingHasNoEffectUnlessTripped) {
  serve();
  connect();
  ASSERT_TRUE(feel());
  EXPECT_EQ(kerf_agent_rearm(agent_), KERF_AGENT_OK);
  int ticks = 0;
  ASSERT_TRUE(tick_until(pose_at(-kPressedMm), [&] {
    EXPECT_NE(status().phase, std::uint32_t{KERF_AGENT_PHASE_READY});
    return ++ticks > 20;
  }));
}

TEST_F(LibraryTest, DeviceWithoutMotorsGetsNoForce) {
  serve();
  device_.actuated_dof = 0;
  device_.max_force_n = 0;
  connect();
  int ticks = 0;
  double most = 0;
  const auto pressed_for = [&](double z_mm, int count) {
    ticks = 0;
    return tick_until(pose_at(z_mm), [&] {
      most = std::max(most, norm(wrench_.force_n));
      return ++ticks > count;
    });
  };
  ASSERT_TRUE(pressed_for(0.1, 700));
  ASSERT_TRUE(pressed_for(-0.5, 200));
  EXPECT_NEAR(status().computed_force_n[2], 0.5 * kNPerMm, 0.1);
  EXPECT_EQ(most, 0);
}

TEST_F(LibraryTest, StatusStatesWhyThereIsNoForceAndTheRemedy) {
  serve();
  device_.flags = KERF_AGENT_HAS_DEADMAN;
  connect();
  int ticks = 0;
  ASSERT_TRUE(tick_until(pose_at(1), [&] { return ++ticks > 100; }));
  EXPECT_STREQ(status().no_force_name, "not_held");
  EXPECT_NE(std::string(status().no_force_text).find("hold its grip"), std::string::npos);
  ASSERT_TRUE(feel(KERF_AGENT_DEADMAN));
  tick(pose_at(std::numeric_limits<double>::infinity()));
  EXPECT_STREQ(status().no_force_name, "tripped");
  const std::string text = status().no_force_text;
  EXPECT_NE(text.find("not a number"), std::string::npos) << text;
  EXPECT_NE(text.find("release the device for 0.3 s"), std::string::npos) << text;
}

TEST_F(LibraryTest, PressOfTheRearmButtonEndsATrip) {
  serve();
  connect();
  ASSERT_TRUE(feel());
  tick(pose_at(std::numeric_limits<double>::infinity()));
  ASSERT_EQ(status().tripped, 1U);
  ASSERT_TRUE(tick_until(pose_at(1, KERF_AGENT_REARM), [&] { return status().tripped == 0; }));
  EXPECT_TRUE(feel());
}

TEST_F(LibraryTest, CallersWithAnOlderHeaderGetItsStatusFields) {
  serve();
  connect();
  auto known = sized<kerf_agent_status>();
  known.struct_size = offsetof(kerf_agent_status, no_force_name);
  const char* const untouched = "untouched";
  known.no_force_name = untouched;
  EXPECT_EQ(kerf_agent_get_status(agent_, &known), KERF_AGENT_OK);
  EXPECT_EQ(known.no_force_name, untouched);
}

}  // namespace
}  // namespace kerf::agent::library_safety_test
