// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/servo/passivity.h"

#include "tests/agent/servo/adversary.h"
#include "tests/support/test.h"

namespace kerf::agent::passivity_test {
namespace {

constexpr std::uint64_t kStartUs = 1'000'000, kTickUs = 1000;

Twist moving(double x_mm_per_s) { return {{x_mm_per_s, 0, 0}, {}}; }
Wrench pushing(double fx_n) { return {{fx_n, 0, 0}, {}}; }

/// A passivity layer whose last wrench was `written` and acted while the device moved by
/// `moved_mm`. Its level is the negative of the work, because it began empty.
Passivity after(const Wrench& written, Vec3 moved_mm, PassivitySettings settings = {}) {
  settings.start_mj = 0;
  Passivity passivity(settings);
  passivity.wrote(written, kStartUs - 20 * kTickUs);
  passivity.settle({moved_mm, {}}, kStartUs - kTickUs, kStartUs);
  passivity.wrote({}, kStartUs);
  return passivity;
}
/// A passivity layer with `level_mj` >= 0 in its account.
Passivity filled(double level_mj, PassivitySettings settings = {}) {
  return after(pushing(-1), {level_mj, 0, 0}, settings);
}

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

TEST(Passivity, CoversTheFirstCutBeforeTheUserHasDoneWork) {
  PassivitySettings reference{.latency_us = 3000, .mass_kg = 0.15, .inertia_kg_m2 = 2e-4};
  const Wrench cut{{0, 0, 1.5}, {90, 0, 0}};
  EXPECT_EQ(Passivity(reference).share(cut, {}, kStartUs), 1);
  reference.start_mj = 0;
  EXPECT_LT(Passivity(reference).share(cut, {}, kStartUs), 0.01);
}

TEST(WrittenWrenches, SettleTheGreatestPossibleWork) {
  WrittenWrenches written;
  for (std::uint64_t tick = 0; tick < 8; ++tick)
    written.write(pushing(static_cast<double>(tick)), kStartUs + tick * kTickUs);
  const auto greatest = [&](double moved_mm, std::uint64_t latency_us) {
    const Twist moved{{moved_mm, 0, 0}, {}};
    return written.greatest_work(moved, kStartUs + 7 * kTickUs, kStartUs + 8 * kTickUs, latency_us);
  };
  EXPECT_DOUBLE_EQ(greatest(1, 0), 7) << "without latency, the newest has acted";
  EXPECT_DOUBLE_EQ(greatest(-1, 0), -7);
  EXPECT_DOUBLE_EQ(greatest(1, 3000), 7);
  EXPECT_DOUBLE_EQ(greatest(-1, 3000), -4) << "the oldest that a latency of 3 ms leaves";
  EXPECT_DOUBLE_EQ(greatest(-1, 2500), -4) << "it has acted for half of the tick";
}

TEST(Passivity, PassesDissipativeWrenches) {
  Passivity passivity({});
  EXPECT_EQ(passivity.project(pushing(-3), moving(50)), pushing(-3));
  EXPECT_EQ(passivity.projected(), 0U);
}

TEST(Passivity, ReducesADrivingForceToTheAvailableEnergy) {
  Passivity passivity = filled(0.1);  // 20 mW for five ticks
  const Wrench output = passivity.project({{2, 1, 0}, {}}, moving(50));
  EXPECT_NEAR(work(output, moving(50)), 20, 1e-9);
  EXPECT_DOUBLE_EQ(output.force_n.y, 1) << "the component that does no work is kept";
  EXPECT_EQ(passivity.projected(), 1U);
}

TEST(Passivity, DissipatesADeficitWithADamper) {
  Passivity passivity = after(pushing(2), {1, 0, 0}, {.max_damping = 0.02, .max_turn_damping = 5});
  EXPECT_LT(passivity.account().level_mj(), 0);
  const Twist velocity{{30, -40, 0}, {0, 0.1, 0}};
  const Wrench output = passivity.project(pushing(5), velocity);
  EXPECT_NEAR(output.force_n.x, -0.02 * 30, 1e-12);
  EXPECT_NEAR(output.force_n.y, 0.02 * 40, 1e-12);
  EXPECT_NEAR(output.torque_nmm.y, -5 * 0.1, 1e-12);
  EXPECT_GT(passivity.share(output, velocity, kStartUs), 0.1) << "a damper may act";
  EXPECT_TRUE(passivity.starving());
}

TEST(Passivity, ShareCoversTheLongestToleratedTick) {
  Passivity passivity = filled(2, {.longest_tick_us = 5000, .mass_kg = 1e6});
  // 4 N at 200 mm/s for 5 ms is 4 mJ.
  EXPECT_NEAR(passivity.share(pushing(4), moving(200), kStartUs), 0.5, 1e-3);
  EXPECT_EQ(passivity.share(pushing(-4), moving(200), kStartUs), 1);
}

TEST(Passivity, ShareCoversWrenchesStillActing) {
  Passivity passivity = filled(4, {.latency_us = 3000, .mass_kg = 1e6});
  passivity.wrote(pushing(4), kStartUs);
  // The written 4 N may act for 3 ms, 2.4 mJ. The remaining 1.6 mJ must cover 5 ms.
  EXPECT_NEAR(passivity.share(pushing(4), moving(200), kStartUs), 0.4, 1e-3);
  passivity.wrote(pushing(4), kStartUs + 1000);
  EXPECT_NEAR(passivity.share(pushing(4), moving(200), kStartUs + 1000), 0.4, 1e-3)
      << "no more: one wrench acts at a time";
}

TEST(Passivity, ShareCoversTheMotionOfALightDeviceAtRest) {
  const PassivitySettings light{.start_mj = 0, .longest_tick_us = 5000, .mass_kg = 0.05};
  Passivity passivity = filled(1, light);
  // 8 N accelerate 50 g within 5 ms to 0.8 m/s: 16 mJ.
  EXPECT_NEAR(passivity.share(pushing(8), {}, kStartUs), 0.25, 1e-3);
  EXPECT_EQ(Passivity(light).share(pushing(1), {}, kStartUs), 0) << "at rest and empty: no force";
  Passivity pen = filled(1, {.longest_tick_us = 5000, .mass_kg = 1e6, .inertia_kg_m2 = 1e-5});
  // 100 N mm turn 1e-5 kg m² within 5 ms at 50 rad/s: 12.5 mJ.
  EXPECT_NEAR(pen.share({{}, {0, 100, 0}}, {}, kStartUs), std::sqrt(1 / 12.5), 1e-3);
}

TEST(Passivity, IsOverdrawnOnlyBeyondTheReserve) {
  const PassivitySettings settings{.tank_mj = 30, .reserve_mj = 5};
  EXPECT_DOUBLE_EQ(Passivity(settings).account().ceiling_mj(), 20);
  EXPECT_FALSE(after(pushing(4), {1, 0, 0}, settings).overdrawn());
  Passivity passivity = after(pushing(6), {1, 0, 0}, settings);
  EXPECT_TRUE(passivity.overdrawn());
  EXPECT_EQ(passivity.project(pushing(-1), moving(50)), Wrench{})
      << "not even a dissipative wrench";
  EXPECT_EQ(passivity.share(pushing(-1), moving(50), kStartUs), 0);
  passivity.restart();
  EXPECT_EQ(passivity.project(pushing(-1), moving(50)), pushing(-1));
  EXPECT_EQ(Passivity({.tank_mj = 30, .reserve_mj = 13, .start_mj = 6}).account().level_mj(), 4)
      << "it begins at its ceiling at most";
}

/// Tests the bound on random traces. plant_bench runs a hundred thousand.
constexpr std::uint32_t kTraces = 3000;
constexpr int kTicks = 1000;

TEST(PassivityProperty, ReturnedEnergyIsBoundedByTheTank) {
  const WorstReturn worst = worst_return<CarryDeficit>(1, kTraces, kTicks);
  EXPECT_TRUE(worst.kept_limits);
  EXPECT_GT(worst.returned_mj, 0.4 * PassivitySettings{}.tank_mj)
      << "the traces must approach the bound";
  EXPECT_LE(worst.returned_mj, PassivitySettings{}.tank_mj) << "seed " << worst.seed;
}

TEST(PassivityProperty, BoundIsViolatedIfTheWrittenWrenchIsSettled) {
  const WorstReturn worst = worst_return<CarryDeficit>(1, 60, kTicks, {.ignores_latency = true});
  EXPECT_GT(worst.returned_mj, 2 * PassivitySettings{}.tank_mj);
}

TEST(PassivityProperty, BoundIsViolatedIfADeficitIsForgiven) {
  // The motion of a device lighter than declared exceeds every estimate.
  const AdversaryFaults light{.declares_too_much_mass = true};
  EXPECT_GT(worst_return<ForgiveDeficit>(1, 200, 2 * kTicks, light).returned_mj,
            2 * PassivitySettings{}.tank_mj);
  EXPECT_LE(worst_return<CarryDeficit>(1, 200, 2 * kTicks, light).returned_mj,
            PassivitySettings{}.tank_mj);
}

TEST(PassivityProperty, RotationOfALightPenIsBoundedByItsCharge) {
  constexpr std::uint32_t kPens = 600;
  const auto returned = [](const AdversaryFaults& faults) {
    return worst_return<CarryDeficit>(0, kPens, 2 * kTicks, faults).returned_mj;
  };
  EXPECT_GT(returned({.lightest_pen = true, .ignores_turning = true}), PassivitySettings{}.tank_mj);
  // A damper that is too strong is shortened to the charge.
  EXPECT_LE(returned({.lightest_pen = true, .damps_turning_freely = true}),
            0.8 * PassivitySettings{}.tank_mj);
}

}  // namespace
}  // namespace kerf::agent::passivity_test
