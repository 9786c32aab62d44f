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

TEST(EnergyAccount, FillsToTheCeilingAndCarriesADeficit) {
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

TEST(Passivity, PassesDissipativeWrenches) {
  Passivity passivity({});
  EXPECT_EQ(passivity.admit(pushing(-3), moving(50), kDt), pushing(-3));
  EXPECT_EQ(passivity.projected(), 0U);
}

TEST(Passivity, ReducesADrivingForceToTheAvailableEnergy) {
  Passivity passivity({});
  passivity.settle(pushing(-1), {{0.02, 0, 0}, {}});  // 0.02 mJ: 20 mW for one tick
  const Wrench output = passivity.admit({{2, 1, 0}, {}}, moving(50), kDt);
  EXPECT_NEAR(work(output, moving(50)), 20, 1e-9);
  EXPECT_DOUBLE_EQ(output.force_n.y, 1) << "the component that does no work is kept";
  EXPECT_EQ(passivity.projected(), 1U);
}

TEST(Passivity, DissipatesADeficitWithADamper) {
  Passivity passivity({.max_damping = 0.02});
  passivity.settle(pushing(2), {{1, 0, 0}, {}});
  EXPECT_LT(passivity.account().level_mj(), 0);
  const Twist velocity{{30, -40, 0}, {0, 0.1, 0}};
  const Wrench output = passivity.admit(pushing(5), velocity, kDt);
  EXPECT_NEAR(output.force_n.x, -0.02 * 30, 1e-12);
  EXPECT_NEAR(output.force_n.y, 0.02 * 40, 1e-12);
  EXPECT_NEAR(output.torque_nmm.y, -0.02 * kMetricArmMm * kMetricArmMm * 0.1, 1e-12);
  EXPECT_TRUE(passivity.starving());
}

TEST(Passivity, AtRestForceRequiresAPositiveLevel) {
  Passivity passivity({});
  EXPECT_EQ(passivity.admit(pushing(1), moving(0.5), kDt), Wrench{});
  EXPECT_TRUE(passivity.starving());
  passivity.settle(pushing(-1), {{0.5, 0, 0}, {}});
  EXPECT_EQ(passivity.admit(pushing(1), moving(0.5), kDt), pushing(1));
  EXPECT_FALSE(passivity.starving());
}

TEST(Passivity, IsOverdrawnOnlyBeyondTheReserve) {
  Passivity passivity({.tank_mj = 30, .reserve_mj = 5});
  EXPECT_DOUBLE_EQ(passivity.account().ceiling_mj(), 20);
  passivity.settle(pushing(4), {{1, 0, 0}, {}});
  EXPECT_FALSE(passivity.overdrawn());
  passivity.settle(pushing(2), {{1, 0, 0}, {}});
  EXPECT_TRUE(passivity.overdrawn());
  EXPECT_EQ(passivity.admit(pushing(-1), moving(50), kDt), Wrench{})
      << "not even a dissipative wrench";
  passivity.restart();
  EXPECT_EQ(passivity.admit(pushing(-1), moving(50), kDt), pushing(-1));
}

/// Tests the bound on random traces; passivity_soak runs a hundred thousand.
constexpr std::uint32_t kTraces = 3000;
constexpr int kTicks = 1000;

TEST(PassivityProperty, ReturnedEnergyIsBoundedByTheTank) {
  const WorstReturn worst = worst_return<CarryDeficit>(1, kTraces, kTicks);
  EXPECT_TRUE(worst.kept_limits);
  EXPECT_GT(worst.returned_mj, 0.5 * PassivitySettings{}.tank_mj)
      << "the traces must approach the bound";
  EXPECT_LE(worst.returned_mj, PassivitySettings{}.tank_mj) << "seed " << worst.seed;
}

TEST(PassivityProperty, BoundIsViolatedIfADeficitIsForgiven) {
  const WorstReturn worst = worst_return<ForgiveDeficit>(1, 60, kTicks);
  EXPECT_GT(worst.returned_mj, 2 * PassivitySettings{}.tank_mj);
}

}  // namespace
}  // namespace kerf::agent
