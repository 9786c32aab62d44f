// SPDX-License-Identifier: Apache-2.0
#include "tests/sim/world/world.h"

#include <gtest/gtest.h>

#include "tests/sim/world/process.h"
#include "tests/support/temporary_folder.h"

namespace kerf::sim {
namespace {

class WorldTest : public testing::Test {
 protected:
  /// Runs a plan under some seeds; the faults of all.
  std::string faults_of(Plan plan, std::uint64_t seeds = 3) const {
    std::string faults;
    for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
      plan.seed = seed;
      faults += run_world(plan, folder_ / std::to_string(seed)).faults;
    }
    return faults;
  }

  /// Two servers and a hand.
  static Plan cluster() {
    Plan plan;
    plan.servers = 2;
    plan.hands = 1;
    plan.clerks = 0;
    plan.length = 4 * kSecond;
    return plan;
  }

  const test::TemporaryFolder folder_;
};

TEST_F(WorldTest, NothingIsLostWithoutFaults) {
  Plan plan;
  plan.length = 2 * kSecond;
  plan.pages = 1;
  EXPECT_EQ(faults_of(plan), "");
  plan.servers = 2;
  plan.follows = true;
  EXPECT_EQ(faults_of(plan), "");
}

/// It waited for the message after the last one that it had seen, which NATS had not any more.
TEST_F(WorldTest, AFollowerNoticesThatNatsHasLostMessages) {
  Plan plan = cluster();
  plan.follows = true;
  plan.length = 3 * kSecond;
  // The hand ends while NATS is away: no message after it brings a follower up to date.
  plan.faults.push_back({.at = 2800 * kMillisecond,
                         .fault = Fault::kNatsEarlier,
                         .server = 0,
                         .length = 600 * kMillisecond});
  EXPECT_EQ(faults_of(plan), "");
}

TEST_F(WorldTest, ASessionGoesOnWhenItsServerIsGoneAndNatsHasAnEarlierStore) {
  Plan plan = cluster();
  plan.faults = {{.at = 2500 * kMillisecond, .fault = Fault::kNatsEarlier, .length = kSecond},
                 {.at = 2600 * kMillisecond, .fault = Fault::kKill, .for_good = true}};
  EXPECT_EQ(faults_of(plan), "");
}

TEST_F(WorldTest, AnOwnerThatNatsDoesNotHearPausesBeforeAnotherOneGoesOn) {
  Plan plan = cluster();
  plan.length = 8 * kSecond;
  plan.faults = {{.at = kSecond, .fault = Fault::kNatsCutOff, .length = 5 * kSecond}};
  EXPECT_EQ(faults_of(plan), "");
}

TEST_F(WorldTest, AStoppedOwnerThatIsContinuedChangesNothing) {
  Plan plan = cluster();
  plan.length = 8 * kSecond;
  plan.faults = {{.at = kSecond, .fault = Fault::kStandStill, .length = 6 * kSecond}};
  EXPECT_EQ(faults_of(plan), "");
}

TEST_F(WorldTest, TheTimeOfDayDecidesNothing) {
  Plan plan = cluster();
  plan.faults = {{.at = 500 * kMillisecond, .fault = Fault::kClockForward, .server = 0},
                 {.at = 600 * kMillisecond, .fault = Fault::kClockBack, .server = 1},
                 {.at = 1500 * kMillisecond, .fault = Fault::kClockBack, .server = 0},
                 {.at = 2000 * kMillisecond, .fault = Fault::kKill, .for_good = true}};
  EXPECT_EQ(faults_of(plan), "");
}

TEST_F(WorldTest, SamplesThatAKillHasLostAreSentAgain) {
  Plan plan;
  plan.clerks = 0;
  plan.period = 2 * kMillisecond;
  for (int n = 1; n <= 5; ++n) {
    const Fault fault = n % 2 == 0 ? Fault::kKill : Fault::kPowerLoss;
    plan.faults.push_back({.at = n * kSecond, .fault = fault, .length = 20 * kMillisecond});
  }
  EXPECT_EQ(faults_of(plan), "");
}

TEST_F(WorldTest, AHandThatIsOfflineWhileItsServerIsRestartedGoesOnWithoutAGap) {
  Plan plan;
  plan.clerks = 0;
  plan.period = 2 * kMillisecond;
  plan.faults = {{.at = kSecond, .fault = Fault::kCut},
                 {.at = kSecond + kMillisecond, .fault = Fault::kRestart, .length = kSecond}};
  EXPECT_EQ(faults_of(plan), "");
}

/// An older state of the block reached the feed after a newer one, on a busy machine only.
TEST_F(WorldTest, APageShowsTheLastCutOfABusyServer) {
  Plan plan;
  plan.hands = 1;
  plan.clerks = 0;
  plan.pages = 2;
  plan.length = kSecond;
  plan.faults = {{.at = 300 * kMillisecond, .fault = Fault::kBusy, .length = kSecond}};
  EXPECT_EQ(faults_of(plan, 60), "");
}

}  // namespace
}  // namespace kerf::sim
