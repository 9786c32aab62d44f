// SPDX-License-Identifier: Apache-2.0
#include "tests/sim/world/world.h"

#include "tests/sim/world/process.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test.h"

namespace kerf::sim::world_test {
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
    return Plan{.servers = 2, .hands = 1, .clerks = 0, .length = 4 * kSecond};
  }

  const test::TemporaryFolder folder_;
};

TEST_F(WorldTest, NothingIsLostWithoutFaults) {
  Plan plan{.pages = 1, .length = 2 * kSecond};
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
  Plan plan{.clerks = 0, .period = 2 * kMillisecond};
  for (int n = 1; n <= 5; ++n) {
    const Fault fault = n % 2 == 0 ? Fault::kKill : Fault::kPowerLoss;
    plan.faults.push_back({.at = n * kSecond, .fault = fault, .length = 20 * kMillisecond});
  }
  EXPECT_EQ(faults_of(plan), "");
}

TEST_F(WorldTest, AHandThatIsOfflineWhileItsServerIsRestartedGoesOnWithoutAGap) {
  Plan plan{
      .clerks = 0,
      .period = 2 * kMillisecond,
      .faults = {{.at = kSecond, .fault = Fault::kCut},
                 {.at = kSecond + kMillisecond, .fault = Fault::kRestart, .length = kSecond}}};
  EXPECT_EQ(faults_of(plan), "");
}

/// An older state of the block reached the feed after a newer one, on a busy machine only.
TEST_F(WorldTest, APageShowsTheLastCutOfABusyServer) {
  Plan plan{.hands = 1,
            .clerks = 0,
            .pages = 2,
            .length = kSecond,
            .faults = {{.at = 300 * kMillisecond, .fault = Fault::kBusy, .length = kSecond}}};
  EXPECT_EQ(faults_of(plan, 60), "");
}

/// A change of plan_of() gives the seeds other worlds: README.md then needs others.
TEST(PlanOfSeed, SeedsOfTheReadmeHaveTheirFault) {
  const std::pair<std::uint64_t, Fault> named[] = {
      {174, Fault::kKill},        {1585, Fault::kKill},       {227, Fault::kPowerLoss},
      {610, Fault::kRestart},     {5577, Fault::kStandStill}, {94, Fault::kCut},
      {1322, Fault::kDiskFull},   {478, Fault::kDiskFails},   {194, Fault::kNoSync},
      {2050, Fault::kDiskSlow},   {451, Fault::kNoMemory},    {19, Fault::kClockForward},
      {342, Fault::kClockBack},   {3736, Fault::kNatsGone},   {2186, Fault::kNatsEarlier},
      {3867, Fault::kNatsCutOff}, {191, Fault::kBusy}};
  for (const auto& [seed, fault] : named) {
    const Plan plan = plan_of(seed);
    ASSERT_EQ(plan.faults.size(), 1U) << describe(plan);
    EXPECT_EQ(plan.faults[0].fault, fault) << describe(plan);
    EXPECT_EQ(plan.clerks, 1) << "the promises of several are not checked";
  }
  EXPECT_TRUE(plan_of(1585).faults[0].for_good);
  const Plan disk = plan_of(2850);
  ASSERT_EQ(disk.faults.size(), 3U) << describe(disk);
  EXPECT_EQ(disk.faults[0].fault, Fault::kNoSync);
  EXPECT_EQ(disk.faults[2].fault, Fault::kPowerLoss);
  EXPECT_LT(disk.faults[2].at, disk.faults[0].at + disk.faults[0].length);
  EXPECT_EQ(plan_of(285).faults.size(), 5U);
  EXPECT_TRUE(plan_of(192).faults.empty());
  EXPECT_EQ(plan_of(192).nats_loses, 0.01);
  const Plan clocks = plan_of(328);
  EXPECT_TRUE(clocks.faults.empty());
  EXPECT_EQ(clocks.clock_rates[0], 1.05);
  EXPECT_EQ(clocks.clock_rates[1], 0.95);
}

}  // namespace
}  // namespace kerf::sim::world_test
