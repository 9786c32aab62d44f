// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/servo/lost_ticks.h"

#include <algorithm>

#include "tests/agent/servo/supervisor_rig.h"

namespace kerf::agent::lost_ticks_test {
namespace {

class LostTicksTest : public SupervisorTest {
 protected:
  /// Runs ticks, of which each `every`-th follows `lost` lost ones. Returns the least gain.
  double lose(std::uint64_t lost, int every, int ticks) {
    double least = 1;
    for (int i = 0; i < ticks; ++i) {
      in.lost_now = i % every == every - 1 ? lost : 0;
      in.dt_s = 1e-3 * static_cast<double>(in.lost_now + 1);
      in.now_us += kMs * (in.lost_now + 1);
      least = std::min(least, supervisor.tick(in));
    }
    in.lost_now = 0;
    in.dt_s = 1e-3;
    return least;
  }
};

TEST_F(LostTicksTest, FewLostTicksReduceTheForceWithoutATrip) {
  arm();
  // 4 in a row, 2 % of a second. The mean length at a random time is 1.1 ms.
  EXPECT_NEAR(lose(4, 200, 2000), 1 / 1.1, 0.02);
  EXPECT_EQ(supervisor.trips(), 0U);
  EXPECT_EQ(supervisor.phase(), ServoPhase::kDegraded);
  EXPECT_EQ(supervisor.no_force(), NoForce::kTicksLost);
  EXPECT_EQ(pass(2000), 1);
  EXPECT_EQ(supervisor.phase(), ServoPhase::kActive);
  EXPECT_EQ(supervisor.no_force(), NoForce::kNone);
}

TEST_F(LostTicksTest, TheGainIsThatOfTheMeanTick) {
  arm();
  // Each second tick follows one lost tick: ticks of 1 and 2 ms, (1 + 4) / (1 + 2) = 5/3 ms.
  EXPECT_NEAR(lose(1, 2, 2000), 0.6, 0.01);
  // Ticks of 2 ms throughout would mean half of all ticks lost.
  EXPECT_EQ(supervisor.trips(), 0U);
}

TEST_F(LostTicksTest, HalfLostOrFiveInARowTrip) {
  arm();
  lose(3, 2, 1000);
  EXPECT_EQ(to_string(supervisor.code()), to_string(TripCode::kLostTicks));
  supervisor = Supervisor(limits);
  arm();
  lose(5, 1, 1);
  EXPECT_EQ(to_string(supervisor.code()), to_string(TripCode::kLostTicksInARow));
}

TEST_F(LostTicksTest, TheForceReturnsInSmallSteps) {
  arm();
  lose(4, 5, 500);
  double before = pass(1);
  EXPECT_LT(before, 0.6);
  for (int i = 0; i < 2000; ++i) {
    const double now = pass(1);
    EXPECT_LE(now - before, 0.0021) << i;
    before = now;
  }
  EXPECT_EQ(before, 1);
}

TEST_F(LostTicksTest, TicksLostWithoutAForceDoNotCount) {
  in.deadman = false;
  lose(5000, 1, 1);
  in.deadman = true;
  arm();
  EXPECT_EQ(supervisor.trips(), 0U);
}

}  // namespace
}  // namespace kerf::agent::lost_ticks_test
