// SPDX-License-Identifier: Apache-2.0
// Why there is no force: the reason, its sentence, and the time of the notification.
#include "haptic_agent/servo/no_force.h"

#include <string>
#include <vector>

#include "haptic_agent/force_watch.h"
#include "tests/agent/servo/supervisor_rig.h"

namespace kerf::agent::no_force_test {
namespace {

class NoForceTest : public SupervisorTest {
 protected:
  std::string_view reason() const { return to_string(supervisor.no_force()); }
};

TEST_F(NoForceTest, NamesTheMissingConditionBeforeArming) {
  in.present = false;
  in.device = DevicePhase::kClosed;
  pass(10);
  EXPECT_EQ(reason(), "absent");
  in.device = DevicePhase::kHoming;
  pass(10);
  EXPECT_EQ(reason(), "homing");
  in.device = DevicePhase::kIdentified;
  pass(10);
  EXPECT_EQ(reason(), "fault");
  in.present = true;
  in.deadman = false;
  pass(10);
  EXPECT_EQ(reason(), "not_held");
  in.deadman = true;
  in.has_answer = false;
  pass(10);
  EXPECT_EQ(reason(), "no_answer");
  in.has_answer = true;
  in.requested.force_n = {0, 0, 1};
  pass(10);
  EXPECT_EQ(reason(), "touching");
  in.requested = {};
  in.tip_mm_per_s = 80;
  pass(10);
  EXPECT_EQ(reason(), "moving");
  in.tip_mm_per_s = 0;
  pass(10);
  EXPECT_EQ(reason(), "arming");
  arm();
  EXPECT_EQ(reason(), "none");
}

TEST_F(NoForceTest, NamesTheCauseOfAReducedForce) {
  arm();
  in.limited = true;
  pass(1);
  EXPECT_EQ(reason(), "limited");
  in.clutched = true;
  pass(1);
  EXPECT_EQ(reason(), "clutched");
  in.clutched = false;
  in.starving = true;
  pass(1);
  EXPECT_EQ(reason(), "tank_empty");
  in.faded = true;
  pass(1);
  EXPECT_EQ(reason(), "server_late");
  in.lost_now = 5;
  pass(1);
  EXPECT_EQ(reason(), "tripped");
}

TEST_F(NoForceTest, DeviceWithoutMotorsHasItsOwnReason) {
  limits.motors = false;
  supervisor = Supervisor(limits);
  pass(1);
  EXPECT_EQ(reason(), "no_motors");
}

TEST(ForceReasons, EachHasASentenceWithARemedyForTheDevice) {
  const ForceReasons held({.has_deadman = true}), button({}), none({.always_cut = true});
  for (std::size_t i = 1; i < kNoForceNames.size(); ++i) {
    const std::string& text = held.of(static_cast<NoForce>(i), TripCode::kSpeed);
    EXPECT_GT(text.size(), 20U) << kNoForceNames[i];
    EXPECT_FALSE(text.ends_with('.')) << text;
    const bool has_remedy =
        text.find("; ") != std::string::npos || text.find(". To ") != std::string::npos;
    EXPECT_TRUE(has_remedy) << text;
  }
  EXPECT_EQ(held.of(NoForce::kNone, TripCode::kSpeed), "");
  const auto has = [](const ForceReasons& reasons, const char* part) {
    return reasons.of(NoForce::kTripped, TripCode::kSpeed).find(part) != std::string::npos;
  };
  EXPECT_TRUE(has(held, "1 m/s") && has(held, "release the device"));
  EXPECT_TRUE(has(button, "still for a second") && has(button, "button"));
  EXPECT_TRUE(has(none, "still for a second") && !has(none, "button"));
}

class ForceWatchTest : public ::testing::Test {
 protected:
  /// Looks ten times per second. Returns the notifications to the user.
  std::vector<std::string> pass(NoForce reason, double seconds) {
    std::vector<std::string> lines;
    for (int i = 0; i < static_cast<int>(seconds * 10); ++i) {
      now_us += 100'000;
      if (std::string line = watch.look(reason, now_us); !line.empty()) lines.push_back(line);
    }
    return lines;
  }

  ForceReasons reasons{DeviceCapabilities{}};
  ForceWatch watch{reasons};
  std::uint64_t now_us = 1'000'000;
};

TEST_F(ForceWatchTest, ReportsALastingReasonOnceAndTheReturnOfTheForce) {
  EXPECT_TRUE(pass(NoForce::kArming, 1).empty());
  EXPECT_TRUE(pass(NoForce::kNone, 5).empty());
  EXPECT_TRUE(pass(NoForce::kNotHeld, 0.4).empty());
  const auto lines = pass(NoForce::kNotHeld, 60);
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_TRUE(lines[0].starts_with("no force: the device is not held")) << lines[0];
  EXPECT_TRUE(pass(NoForce::kArming, 1).empty());
  EXPECT_EQ(pass(NoForce::kNone, 10), std::vector<std::string>{"the force is on"});
}

TEST_F(ForceWatchTest, ReportsAReducedForceOncePerMinute) {
  std::size_t lines = 0;
  for (int i = 0; i < 60; ++i) {
    lines += pass(NoForce::kLimited, 1.5).size();
    lines += pass(NoForce::kNone, 0.5).size();
  }
  EXPECT_EQ(lines, 2U);
}

TEST_F(ForceWatchTest, AlternatingReasonsAreNotReported) {
  for (int i = 0; i < 100; ++i) {
    EXPECT_TRUE(pass(NoForce::kTouching, 0.3).empty());
    EXPECT_TRUE(pass(NoForce::kMoving, 0.3).empty());
  }
}

TEST_F(ForceWatchTest, ReportsTheEndOfATripButNotTheTrip) {
  EXPECT_TRUE(pass(NoForce::kTripped, 10).empty());
  EXPECT_EQ(pass(NoForce::kNone, 1).size(), 1U);
}

}  // namespace
}  // namespace kerf::agent::no_force_test
