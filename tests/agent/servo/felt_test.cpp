// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/servo/felt.h"

#include "haptic_agent/servo/servo_cycle.h"
#include "tests/support/test.h"

namespace kerf::agent::felt_test {
namespace {

constexpr double kPivotMm = 50;

TEST(FeltShare, IsTheFactorOfAShortenedWrenchAndIgnoresOrthogonalParts) {
  const Wrench computed{{-18, 0, 2}, {0, 900, 0}};
  EXPECT_DOUBLE_EQ(felt_share(computed, computed, kPivotMm), 1);
  EXPECT_NEAR(felt_share(computed * 0.17, computed, kPivotMm), 0.17, 1e-12);
  const Wrench across{{0, 5, 0}, {700, 0, 0}};
  EXPECT_NEAR(felt_share(computed * 0.17 + across, computed, kPivotMm), 0.17, 1e-12);
  EXPECT_EQ(felt_share(computed * -1, computed, kPivotMm), 0) << "never below zero";
  EXPECT_EQ(felt_share(computed * 2, computed, kPivotMm), 1) << "never above one";
}

TEST(FeltShare, IsFiniteForAnyComputedWrench) {
  EXPECT_EQ(felt_share({}, {}, kPivotMm), 1) << "nothing is missing";
  for (const double bad :
       {std::numeric_limits<double>::infinity(), 1e200, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_EQ(felt_share({}, {{bad, 0, 0}, {}}, kPivotMm), 0);
  }
}

/// A device with motors that the user holds and moves down.
class HeldDevice final : public HapticDevice {
 public:
  DeviceCapabilities capabilities() const override {
    return {.name = "held", .max_force_n = max_force_n, .max_torque_nmm = 250};
  }
  DeviceState read(std::uint64_t now_us) noexcept override {
    tip_mm.z -= 0.01;
    return {.tip_mm = tip_mm,
            .buttons = buttons,
            .time_us = now_us,
            .valid = true,
            .phase = DevicePhase::kReady};
  }
  void write(const Wrench& wrench) noexcept override { output = wrench; }
  void stop() noexcept override { output = {}; }

  double max_force_n = 5;
  std::uint32_t buttons = wire::kButtonCutting | wire::kButtonDeadman;
  Vec3 tip_mm{};
  Wrench output;
};

class NoListener final : public SampleListener {
 public:
  void sample_ready() noexcept override {}
};

class FeltTest : public ::testing::Test {
 protected:
  /// Runs `ticks` with a server that answers `computed`, after 0.1 s without force, in which the
  /// device arms. Returns the last sample.
  wire::MotionSample run(int ticks, const Wrench& computed, double max_force_n = 5) {
    device.max_force_n = max_force_n;
    ServoSettings settings{.mode = ForceMode::kHold, .passivity = {.mass_kg = 1}};
    cycle.emplace(device, samples, wrenches, listener,
                  settings_for(device.capabilities(), settings));
    wire::MotionSample sample;
    constexpr std::uint64_t kArmedUs = 110'000;
    for (std::uint64_t now_us = 10'000; ticks-- > 0; now_us += 1000) {
      const Wrench wrench = now_us < kArmedUs ? Wrench{} : computed;
      wrenches.write({.wrench = wrench, .pose_us = now_us, .arrival_us = now_us});
      cycle->tick(now_us);
      while (samples.pop(sample)) {
      }
    }
    return sample;
  }

  HeldDevice device;
  SampleRing samples;
  LatestValue<ServerWrench> wrenches;
  NoListener listener;
  std::optional<ServoCycle> cycle;
};

TEST_F(FeltTest, SamplesAndReportStateTheFactorOfTheDevicesLimit) {
  const Wrench computed{{0, 0, 12}, {0, 60, 0}};
  const wire::MotionSample sample = run(2000, computed);  // 0.6 of 5 N
  EXPECT_NE(sample.buttons & wire::kButtonFelt, 0U);
  EXPECT_NEAR(static_cast<double>(sample.felt_share), 0.25, 1e-6);
  EXPECT_NEAR(device.output.force_n.z, 3, 1e-9);
  EXPECT_NEAR(device.output.torque_nmm.y, 15, 1e-9) << "shortened by the same factor";
  const FeltReport& felt = cycle->report().felt;
  EXPECT_GT(felt.ticks, 1500U);
  EXPECT_EQ(felt.reduced_ticks, felt.ticks);
  EXPECT_NEAR(felt.force.computed_mean(), 12, 1e-9);
  EXPECT_NEAR(felt.force.felt_peak(), 3, 1e-9);
  EXPECT_NEAR(felt.force.error(), 0.75, 0.05) << "rms of the difference over the computed force";
  EXPECT_NEAR(felt.torque.error(), 0.75, 0.05);
}

TEST_F(FeltTest, WrenchWithinTheLimitsIsFeltInFull) {
  const wire::MotionSample sample = run(5000, {{0, 0, 2}, {0, 10, 0}});
  EXPECT_FLOAT_EQ(sample.felt_share, 1);
  const FeltReport& felt = cycle->report().felt;
  EXPECT_LT(felt.reduced_ticks, 600U) << "the ramp after arming only";
  EXPECT_NEAR(felt.force.felt_peak(), 2, 1e-9);
}

TEST_F(FeltTest, NothingIsFeltWhileTheDeviceIsNotHeld) {
  device.buttons = wire::kButtonCutting;
  const wire::MotionSample sample = run(300, {{0, 0, 2}, {}});
  EXPECT_NE(sample.buttons & wire::kButtonFelt, 0U);
  EXPECT_EQ(sample.felt_share, 0);
  EXPECT_EQ(cycle->report().felt.ticks, 0U) << "the summary covers ticks with the force on";
}

TEST_F(FeltTest, DeviceWithoutMotorsReportsNoShare) {
  const wire::MotionSample sample = run(300, {{0, 0, 2}, {}}, 0);
  EXPECT_EQ(sample.buttons & wire::kButtonFelt, 0U);
  EXPECT_EQ(sample.felt_share, 0);
}

}  // namespace
}  // namespace kerf::agent::felt_test
