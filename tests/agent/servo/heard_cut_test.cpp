// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/servo/servo_cycle.h"
#include "tests/support/test.h"

namespace kerf::agent::heard_cut_test {
namespace {

/// A tool that moves at 20 mm/s while the cutting button is pressed.
class FeedingDevice final : public HapticDevice {
 public:
  DeviceCapabilities capabilities() const override { return {}; }
  DeviceState read(std::uint64_t now_us) noexcept override {
    state.time_us = now_us;
    if (feeds) state.tip_mm.x += 0.02;
    return state;
  }
  void write(const Wrench&) noexcept override {}
  void stop() noexcept override {}
  DeviceState state{.buttons = wire::kButtonCutting, .valid = true, .phase = DevicePhase::kReady};
  bool feeds = true;
};

class NoListener final : public SampleListener {
 public:
  void sample_ready() noexcept override {}
};

class HeardCutTest : public ::testing::TestWithParam<ForceMode> {
 protected:
  HeardCut ticks(int count, bool answered) {
    for (int i = 0; i < count; ++i, now_us += 1000) {
      if (answered) {
        wrenches.write({.wrench = {.force_n = {-2, 0, 0}, .torque_nmm = {}},
                        .pose_us = now_us,
                        .arrival_us = now_us,
                        .engaged_area_mm2 = 3});
      }
      cycle.tick(now_us);
    }
    HeardCut heard;
    EXPECT_TRUE(cycle.heard().read(heard));
    return heard;
  }

  FeedingDevice device;
  SampleRing samples;
  LatestValue<ServerWrench> wrenches;
  NoListener listener;
  ServoCycle cycle{device, samples, wrenches, listener, {.mode = GetParam()}};
  std::uint64_t now_us = 10'000;
};

TEST_P(HeardCutTest, HasTheSessionsForceAndTheRemovalRate) {
  const HeardCut heard = ticks(200, true);
  EXPECT_TRUE(heard.running);
  EXPECT_NEAR(heard.force_n, 2, 0.05);
  EXPECT_NEAR(heard.removed_mm3_per_s, 3 * 20, 1);
}

TEST_P(HeardCutTest, FadesWhenTheServerIsSilentAndTheTipRests) {
  ticks(200, true);
  device.feeds = false;
  const HeardCut heard = ticks(200, false);
  EXPECT_TRUE(heard.running);
  EXPECT_EQ(heard.force_n, 0);
  EXPECT_NEAR(heard.removed_mm3_per_s, 0, 0.1);
}

TEST_P(HeardCutTest, HasNoSpindleWithoutTheCuttingButtonOrAPose) {
  ticks(200, true);
  device.state.buttons = 0;
  EXPECT_FALSE(ticks(1, true).running);
  device.state.buttons = wire::kButtonCutting;
  EXPECT_TRUE(ticks(1, true).running);
  device.state.valid = false;
  const HeardCut lost = ticks(1, true);
  EXPECT_FALSE(lost.running);
  EXPECT_EQ(lost.force_n, 0);
}

INSTANTIATE_TEST_SUITE_P(Modes, HeardCutTest,
                         ::testing::Values(ForceMode::kModel, ForceMode::kHold));

}  // namespace
}  // namespace kerf::agent::heard_cut_test
