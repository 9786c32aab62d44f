// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/servo/passivity.h"

#include <gtest/gtest.h>

#include <string>

#include "tests/agent/servo/adversary.h"

namespace kerf::agent {
namespace {

constexpr double kDt = 0.001;

Twist moving(double x_mm_per_s) { return {{x_mm_per_s, 0, 0}, {}}; }
Wrench pushing(double fx_n) { return {{fx_n, 0, 0}, {}}; }

TEST(EnergyAccount, FillsToItsCeilingAndCarriesADeficit) {
  BasicEnergyAccount<> account(10);
  account.settle(-25);
  EXPECT_DOUBLE_EQ(account.level_mj(), 10);
  account.settle(12);
  EXPECT_DOUBLE_EQ(account.level_mj(), -2);
  account.settle(-1);
  EXPECT_DOUBLE_EQ(account.level_mj(), -1);
  EXPECT_DOUBLE_EQ(account.given_mj(), -14);
  EXPECT_DOUBLE_EQ(account.most_returned_mj(), 12);
}

TEST(Passivity, LetsPassWhatHoldsTheHandBack) {
  Passivity passivity({});
  EXPECT_EQ(passivity.admit(pushing(-3), moving(50), kDt), pushing(-3));
  EXPECT_EQ(passivity.projected(), 0U);
}

TEST(Passivity, TakesFromADrivingForceJustWhatTheAccountDoesNotCover) {
  Passivity passivity({});
  passivity.settle(pushing(-1), {{0.02, 0, 0}, {}});  // 0.02 mJ: 20 mW for one tick
  const Wrench shown = passivity.admit({{2, 1, 0}, {}}, moving(50), kDt);
  EXPECT_NEAR(work(shown, moving(50)), 20, 1e-9);
  EXPECT_DOUBLE_EQ(shown.force_n.y, 1) << "what does no work is left alone";
  EXPECT_EQ(passivity.projected(), 1U);
}

TEST(Passivity, WorksOffADeficitWithAPureDamper) {
  Passivity passivity({.damping_most = 0.02});
  passivity.settle(pushing(2), {{1, 0, 0}, {}});
  EXPECT_LT(passivity.account().level_mj(), 0);
  const Twist velocity{{30, -40, 0}, {0, 0.1, 0}};
  const Wrench shown = passivity.admit(pushing(5), velocity, kDt);
  EXPECT_NEAR(shown.force_n.x, -0.02 * 30, 1e-12);
  EXPECT_NEAR(shown.force_n.y, 0.02 * 40, 1e-12);
  EXPECT_NEAR(shown.torque_nmm.y, -0.02 * kMetricArmMm * kMetricArmMm * 0.1, 1e-12);
  EXPECT_TRUE(passivity.starving());
}

TEST(Passivity, AHandAtRestFeelsAForceOnlyIfTheAccountHoldsSomething) {
  Passivity passivity({});
  EXPECT_EQ(passivity.admit(pushing(1), moving(0.5), kDt), Wrench{});
  EXPECT_TRUE(passivity.starving());
  passivity.settle(pushing(-1), {{0.5, 0, 0}, {}});
  EXPECT_EQ(passivity.admit(pushing(1), moving(0.5), kDt), pushing(1));
  EXPECT_FALSE(passivity.starving());
}

TEST(Passivity, IsOverdrawnBeyondItsReserveOnly) {
  Passivity passivity({.tank_mj = 30, .reserve_mj = 5});
  EXPECT_DOUBLE_EQ(passivity.account().ceiling_mj(), 20);
  passivity.settle(pushing(4), {{1, 0, 0}, {}});
  EXPECT_FALSE(passivity.overdrawn());
  passivity.settle(pushing(2), {{1, 0, 0}, {}});
  EXPECT_TRUE(passivity.overdrawn());
  EXPECT_EQ(passivity.admit(pushing(-1), moving(50), kDt), Wrench{}) << "not even what brakes";
  passivity.restart();
  EXPECT_EQ(passivity.admit(pushing(-1), moving(50), kDt), pushing(-1));
}

/// The promise. passivity_soak asks it of a hundred thousand traces.
constexpr std::uint32_t kTraces = 3000;
constexpr int kTicks = 1000;

TEST(PassivityProperty, NoNetworkAndNoHandGetMoreOutThanTheTankHolds) {
  const WorstReturn worst = worst_return<CarryDeficit>(1, kTraces, kTicks);
  EXPECT_TRUE(worst.kept_limits);
  EXPECT_GT(worst.returned_mj, 0.5 * PassivitySettings{}.tank_mj) << "the traces must try";
  EXPECT_LE(worst.returned_mj, PassivitySettings{}.tank_mj) << "seed " << worst.seed;
}

TEST(PassivityProperty, FailsAsSoonAsADeficitIsForgiven) {
  const WorstReturn worst = worst_return<ForgiveDeficit>(1, 60, kTicks);
  EXPECT_GT(worst.returned_mj, 2 * PassivitySettings{}.tank_mj);
}

}  // namespace
}  // namespace kerf::agent
