// SPDX-License-Identifier: Apache-2.0
// Devices without a cutting button, and requests to re-arm, in the servo's tick.
#include "haptic_agent/servo/servo_cycle.h"
#include "tests/support/test.h"

namespace kerf::agent::buttons_test {
namespace {

constexpr std::uint64_t kMs = 1000;

class Plain final : public HapticDevice {
 public:
  explicit Plain(bool always_cut, double max_force_n)
      : always_cut_(always_cut), max_force_n_(max_force_n) {}
  DeviceCapabilities capabilities() const override {
    return {.name = "plain", .max_force_n = max_force_n_, .always_cut = always_cut_};
  }
  DeviceState read(std::uint64_t now_us) noexcept override {
    state.time_us = now_us;
    return state;
  }
  void write(const Wrench& wrench) noexcept override { output = wrench; }
  void stop() noexcept override {}

  DeviceState state{.buttons = wire::kButtonDeadman, .valid = true, .phase = DevicePhase::kReady};
  Wrench output;

 private:
  bool always_cut_;
  double max_force_n_;
};

class NoListener final : public SampleListener {
 public:
  void sample_ready() noexcept override {}
};

class Buttons : public ::testing::Test {
 protected:
  void open(bool always_cut, double max_force_n = 20) {
    device.emplace(always_cut, max_force_n);
    cycle.emplace(*device, samples, wrenches, listener,
                  settings_for(device->capabilities(), {.mode = ForceMode::kHold}));
  }
  /// Runs `ms` ticks, answered without force. Returns the number of samples in which the tool cut.
  int pass(int ms) {
    int cut = 0;
    for (int i = 0; i < ms; ++i) {
      now_us += kMs;
      wrenches.write({.pose_us = now_us - kMs, .arrival_us = now_us});
      cycle->tick(now_us);
      wire::MotionSample sample;
      while (samples.pop(sample)) {
        cut += (sample.buttons & wire::kButtonCutting) != 0 ? 1 : 0;
        EXPECT_EQ(sample.buttons & kButtonRearm, 0U);
      }
    }
    return cut;
  }
  void trip() {
    device->state.tip_mm.x += 8;
    pass(1);
    ASSERT_EQ(phase(), ServoPhase::kSafe);
  }
  ServoPhase phase() const { return cycle->supervisor().phase(); }

  SampleRing samples;
  LatestValue<ServerWrench> wrenches;
  NoListener listener;
  std::optional<Plain> device;
  std::optional<ServoCycle> cycle;
  std::uint64_t now_us = 1'000'000;
};

TEST_F(Buttons, ADeviceWithoutAButtonCutsWhileTheForceIsOn) {
  open(true);
  EXPECT_EQ(pass(50), 0) << "not armed yet";
  pass(700);
  ASSERT_EQ(phase(), ServoPhase::kActive);
  EXPECT_EQ(pass(100), 100);
  trip();
  EXPECT_EQ(pass(1000), 0) << "tripped";
  EXPECT_EQ(cycle->no_force(), NoForce::kTripped);
}

TEST_F(Buttons, ADeviceWithAButtonDoesNotCutByItself) {
  open(false);
  EXPECT_EQ(pass(1000), 0);
  device->state.buttons |= wire::kButtonCutting;
  EXPECT_EQ(pass(10), 10);
}

TEST_F(Buttons, ButtonlessDeviceWithoutMotorsAlwaysCuts) {
  open(true, 0);
  pass(1);
  EXPECT_EQ(pass(10), 10);
  device->state.buttons = 0;
  EXPECT_EQ(pass(10), 0) << "not held";
}

TEST_F(Buttons, ReleasedDeviceDoesNotCut) {
  open(true);
  pass(1000);
  device->state.buttons = 0;
  EXPECT_EQ(pass(10), 0);
}

TEST_F(Buttons, APressOfTheButtonRearmsOnce) {
  open(false);
  pass(1000);
  trip();
  device->state.buttons |= kButtonRearm;
  pass(700);
  EXPECT_EQ(phase(), ServoPhase::kActive);
  trip();
  pass(2000);
  EXPECT_EQ(phase(), ServoPhase::kSafe) << "a button that stays pressed asks once";
}

TEST_F(Buttons, AnotherThreadMayRearm) {
  open(true);
  pass(1000);
  trip();
  cycle->rearm();
  pass(700);
  EXPECT_EQ(phase(), ServoPhase::kActive);
  EXPECT_GT(cycle->report().no_force_ticks[static_cast<std::size_t>(NoForce::kArming)], 500U);
}

TEST_F(Buttons, TheGestureRearmsADeviceWithoutAButton) {
  open(true);
  pass(1000);
  trip();
  pass(1100);
  for (int i = 0; i < 240; ++i) {
    device->state.tip_mm.z += i < 120 ? 0.1 : -0.1;
    pass(1);
  }
  pass(700);
  EXPECT_EQ(phase(), ServoPhase::kActive);
  EXPECT_EQ(pass(10), 10);
}

}  // namespace
}  // namespace kerf::agent::buttons_test
