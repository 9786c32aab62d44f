// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/device/regrip.h"

#include "haptic_agent/device/simulated_hand.h"
#include "haptic_agent/servo/servo_cycle.h"
#include "tests/support/test.h"

namespace kerf::agent::regrip_test {
namespace {

constexpr std::uint64_t kMs = 1000;
constexpr double kTickS = 0.001;

class NoListener final : public SampleListener {
 public:
  void sample_ready() noexcept override {}
};

/// A simulated hand that never lifts: it cuts along a line for 20 s, against 2 N while it moves.
class CuttingHand : public ::testing::Test {
 protected:
  /// Runs the loop for a time; `answered`: the server answers in each tick.
  void run(int ms, bool answered = true) {
    for (int i = 0; i < ms; ++i) tick(kMs, answered);
  }
  void tick(std::uint64_t passed_us, bool answered = true) {
    now_us_ += passed_us;
    if (answered) {
      const double newtons = moved_mm_ > 0.001 ? 2 : 0;
      wrenches_.write({.wrench = {.force_n = {-newtons, 0, 0}, .torque_nmm = {}},
                       .pose_us = now_us_ - kMs,
                       .arrival_us = now_us_});
    }
    cycle_.tick(now_us_);
    wire::MotionSample sample;
    while (samples_.pop(sample)) {
      moved_mm_ = sample.tip_mm.x - x_mm_;
      x_mm_ = sample.tip_mm.x;
      held_ = (sample.buttons & wire::kButtonDeadman) != 0;
      cutting_ = (sample.buttons & wire::kButtonCutting) != 0;
    }
  }
  ServoPhase phase() const { return cycle_.supervisor().phase(); }
  static ServoSettings settings(const HapticDevice& device) {
    ServoSettings settings = settings_for(device.capabilities(), {});
    settings.mode = ForceMode::kInterpolated;
    return settings;
  }

  SimulatedHand hand_{PathCursor({{.time_s = 0, .tip_mm = {0, 0, 0}, .cutting = true},
                                  {.time_s = 20, .tip_mm = {400, 0, 0}, .cutting = true}},
                                 false),
                      {.rest_at_start_s = 0.5}};
  SampleRing samples_;
  LatestValue<ServerWrench> wrenches_;
  NoListener listener_;
  ServoCycle cycle_{hand_, samples_, wrenches_, listener_, settings(hand_)};
  std::uint64_t now_us_ = 1'000'000;
  double x_mm_ = 0, moved_mm_ = 0;
  bool held_ = false, cutting_ = false;
};

TEST_F(CuttingHand, FeelsTheCutAgainAfterATrip) {
  run(1500);
  ASSERT_EQ(phase(), ServoPhase::kActive);
  const double before_mm = x_mm_;
  tick(10 * kMs);
  ASSERT_EQ(phase(), ServoPhase::kSafe) << "ticks were lost in a row";
  bool let_go = false;
  for (int i = 0; i < 3000; ++i) {
    tick(kMs);
    let_go = let_go || !held_;
    EXPECT_TRUE(cutting_);
  }
  EXPECT_TRUE(let_go);
  EXPECT_EQ(phase(), ServoPhase::kActive);
  EXPECT_EQ(cycle_.supervisor().trips(), 1U);
  EXPECT_GT(x_mm_, before_mm + 20) << "it goes on along its path";
}

TEST_F(CuttingHand, FeelsTheCutAgainAfterTheServerReturns) {
  run(1500);
  run(3000, false);
  EXPECT_EQ(phase(), ServoPhase::kReady);
  run(8000);
  EXPECT_EQ(phase(), ServoPhase::kActive);
}

TEST_F(CuttingHand, ContinuesWithoutForceWhileTheServerIsSilent) {
  run(4000, false);
  const double before_mm = x_mm_;
  run(4000, false);
  EXPECT_GT(x_mm_, before_mm + 20);
}

TEST(Regrip, WorksWhileThereIsAForce) {
  Regrip user;
  for (int i = 0; i < 10'000; ++i) {
    ASSERT_EQ(user.step(i % 500 == 0, kTickS), Regrip::Act::kWork) << "short gaps are not noticed";
  }
}

TEST(Regrip, TriesAgainLater) {
  Regrip user;
  int let_go = 0;
  Regrip::Act before = Regrip::Act::kWork;
  for (int i = 0; i < 20'000; ++i) {
    const Regrip::Act act = user.step(false, kTickS);
    if (act == Regrip::Act::kLetGo && before != act) ++let_go;
    before = act;
  }
  EXPECT_EQ(let_go, 3) << "at 0.7 s, and 5 s after each wait of 2 s";
}

}  // namespace
}  // namespace kerf::agent::regrip_test
