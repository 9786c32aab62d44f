// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/servo/silence_decay.h"
#include "haptic_agent/servo/wrench_interpolator.h"
#include "haptic_agent/servo/wrench_limiter.h"
#include "tests/support/test.h"

namespace kerf::agent::wrench_test {
namespace {

Wrench force(double x, double y = 0, double z = 0) {
  return {.force_n = {x, y, z}, .torque_nmm = {}};
}

ServerWrench answer(double fx, std::uint64_t arrival_us) {
  return {.wrench = force(fx), .pose_us = arrival_us - 1000, .arrival_us = arrival_us};
}

TEST(WrenchInterpolator, IsZeroBeforeTheFirstAnswer) {
  const WrenchInterpolator interpolator;
  EXPECT_EQ(interpolator.at(123), Wrench{});
}

TEST(WrenchInterpolator, InterpolatesFromThePreviousAnswerToTheNewest) {
  WrenchInterpolator interpolator;
  interpolator.take(answer(0, 10'000), 10'000);
  interpolator.take(answer(4, 20'000), 20'000);
  EXPECT_DOUBLE_EQ(interpolator.at(20'000).force_n.x, 0);
  EXPECT_DOUBLE_EQ(interpolator.at(25'000).force_n.x, 2);
  EXPECT_DOUBLE_EQ(interpolator.at(30'000).force_n.x, 4);
  EXPECT_DOUBLE_EQ(interpolator.at(90'000).force_n.x, 4) << "fading happens elsewhere";
}

TEST(WrenchInterpolator, IsContinuousWhenAnAnswerArrivesEarly) {
  WrenchInterpolator interpolator;
  interpolator.take(answer(0, 10'000), 10'000);
  interpolator.take(answer(10, 20'000), 20'000);
  const double before = interpolator.at(23'000).force_n.x;
  interpolator.take(answer(-10, 23'000), 23'000);
  EXPECT_DOUBLE_EQ(interpolator.at(23'000).force_n.x, before);
  EXPECT_DOUBLE_EQ(interpolator.at(26'000).force_n.x, -10);
}

TEST(WrenchInterpolator, LimitsTheInterpolationTime) {
  WrenchInterpolator interpolator;
  interpolator.take(answer(0, 10'000), 10'000);
  interpolator.take(answer(8, 2'010'000), 2'010'000);
  EXPECT_DOUBLE_EQ(interpolator.at(2'020'000).force_n.x, 4);
  EXPECT_DOUBLE_EQ(interpolator.at(2'030'000).force_n.x, 8);
}

TEST(SilenceDecay, HoldsThenDecaysThenIsZero) {
  EXPECT_EQ(wrench_share(0), 1.0);
  EXPECT_EQ(wrench_share(20'000), 1.0);
  EXPECT_NEAR(wrench_share(60'000), std::exp(-1.0), 1e-12);
  EXPECT_GT(wrench_share(119'999), 0.0);
  EXPECT_EQ(wrench_share(120'000), 0.0);
  EXPECT_EQ(wrench_share(std::numeric_limits<std::uint64_t>::max()), 0.0);
}

TEST(SilenceDecay, ReplicaMasksServerStallsUpTo100Ms) {
  const auto share = [](std::uint64_t silent_us) {
    return wrench_share(replica_age_us(1'000'000 + silent_us, 1'000'000));
  };
  EXPECT_EQ(share(0), 1.0);
  EXPECT_EQ(share(100'000), 1.0);
  EXPECT_LT(share(120'000), 0.5);
  EXPECT_GT(share(120'000), 0.1);
  EXPECT_GT(share(139'000), 0.0);
  EXPECT_EQ(share(140'000), 0.0);
  EXPECT_EQ(replica_age_us(5, 10), 0U) << "an answer with a future arrival time has age zero";
}

TEST(SilenceDecay, AnswersWithGrowingDelayAge) {
  EXPECT_EQ(answer_age_us(1'000'000, 999'000, 985'000), 1000U)
      << "a round trip of 15 ms counts as prompt";
  EXPECT_EQ(answer_age_us(1'000'000, 999'000, 850'000), 130'000U);
  EXPECT_EQ(answer_age_us(1'000'000, 900'000, 899'000), 100'000U);
  EXPECT_EQ(answer_age_us(1'000'000, 1'000'001, 1'000'001), 0U);
}

constexpr double kTickS = 0.001;

TEST(WrenchLimiter, ShortensForceAndTorqueByOneFactor) {
  WrenchLimiter limiter(
      {.force_n = 5, .torque_nmm = 100, .force_rise_n_per_s = 1e9, .torque_rise_nmm_per_s = 1e9});
  const Wrench output = limiter.limit({.force_n = {30, 40, 0}, .torque_nmm = {0, 0, -10}}, kTickS);
  EXPECT_NEAR(output.force_n.x, 3, 1e-12);
  EXPECT_NEAR(output.force_n.y, 4, 1e-12);
  EXPECT_NEAR(output.torque_nmm.z, -1, 1e-12) << "the screw axis stays";
  EXPECT_EQ(limiter.saturated(), 1U);
}

TEST(WrenchLimiter, NextRiseStartsAtTheShortenedOutput) {
  WrenchLimiter limiter({.force_rise_n_per_s = 400});
  for (int i = 0; i < 10; ++i) limiter.limit(force(8), kTickS);
  EXPECT_NEAR(limiter.shorten(0.25).force_n.x, 1, 1e-12);
  EXPECT_NEAR(limiter.limit(force(8), kTickS).force_n.x, 1.4, 1e-12);
}

TEST(WrenchLimiter, RisesSlowlyAndFallsAtOnce) {
  WrenchLimiter limiter({.force_rise_n_per_s = 400});
  EXPECT_NEAR(limiter.limit(force(8), kTickS).force_n.x, 0.4, 1e-12);
  EXPECT_NEAR(limiter.limit(force(8), kTickS).force_n.x, 0.8, 1e-12);
  for (int i = 0; i < 30; ++i) limiter.limit(force(8), kTickS);
  EXPECT_NEAR(limiter.limit(force(8), kTickS).force_n.x, 8, 1e-12);
  EXPECT_NEAR(limiter.limit(force(1), kTickS).force_n.x, 1, 1e-12);
  EXPECT_EQ(limiter.limit(force(0), kTickS), Wrench{});
}

TEST(WrenchLimiter, ReversalPassesThroughZero) {
  WrenchLimiter limiter({.force_rise_n_per_s = 400});
  for (int i = 0; i < 30; ++i) limiter.limit(force(8), kTickS);
  EXPECT_NEAR(limiter.limit(force(-8), kTickS).force_n.x, -0.4, 1e-12);
}

TEST(WrenchLimiter, NonFiniteWrenchGivesZero) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double bad : {nan, std::numeric_limits<double>::infinity(), 1e300}) {
    WrenchLimiter limiter({});
    limiter.limit(force(3), kTickS);
    EXPECT_EQ(limiter.limit(force(bad), kTickS), Wrench{});
    EXPECT_EQ(limiter.limit({.force_n = {}, .torque_nmm = {0, bad, 0}}, kTickS), Wrench{});
    EXPECT_EQ(limiter.not_finite(), 2U);
    EXPECT_GT(limiter.limit(force(3), kTickS).force_n.x, 0) << "the next valid wrench is used";
  }
}

TEST(WrenchLimiter, OutputIsWithinTheLimitsForAnyInput) {
  const WrenchLimits limits;
  WrenchLimiter limiter(limits);
  std::mt19937_64 random(7);
  std::normal_distribution<double> any(0, 12);
  Vec3 last;
  for (int i = 0; i < 100'000; ++i) {
    const Wrench output =
        limiter.limit({.force_n = {any(random), any(random), any(random)},
                       .torque_nmm = {20 * any(random), 20 * any(random), 20 * any(random)}},
                      kTickS);
    ASSERT_LE(length(output.force_n), limits.force_n * (1 + 1e-12));
    ASSERT_LE(length(output.torque_nmm), limits.torque_nmm * (1 + 1e-12));
    ASSERT_LE(length(output.force_n), length(last) + limits.force_rise_n_per_s * kTickS + 1e-12);
    last = output.force_n;
  }
}

TEST(WrenchLimits, AreAShareOfTheDevicesMaximum) {
  const auto limits = within({.name = "d", .max_force_n = 3.3, .max_torque_nmm = 1000}, {});
  EXPECT_NEAR(limits.force_n, 1.98, 1e-12);
  EXPECT_EQ(limits.torque_nmm, WrenchLimits{}.torque_nmm);
  EXPECT_EQ(within({.name = "no motors"}, {}).force_n, WrenchLimits{}.force_n);
}

}  // namespace
}  // namespace kerf::agent::wrench_test
