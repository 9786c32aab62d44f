// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/servo/paper_loop.h"

#include "haptic_agent/servo/servo_cycle.h"
#include "tests/support/test.h"

namespace kerf::agent::paper_loop_test {
namespace {

constexpr std::uint64_t kTickUs = 1000;

Wrench force(double x) { return {.force_n = {x, 0, 0}, .torque_nmm = {0, -60 * x, 0}}; }

TEST(PaperLoop, RampIsShownOneUpdateLate) {
  // 0.5 N per tick. The mean of the ten answers of an update is that of its middle, 4.5 ticks
  // before its end. The interpolation is one update, 10 ticks, later.
  PaperLoop loop;
  constexpr double kPerTick = 0.5, kLate = 10 + 4.5;
  for (int n = 0; n < 500; ++n) {
    loop.take(force(kPerTick * n));
    const Wrench output = loop.at(1'000'000 + static_cast<std::uint64_t>(n) * kTickUs);
    if (n < 30) continue;
    EXPECT_NEAR(output.force_n.x, kPerTick * (n - kLate), 1e-9) << n;
    EXPECT_NEAR(output.torque_nmm.y, -60 * kPerTick * (n - kLate), 1e-9) << n;
  }
}

TEST(PaperLoop, StepTakesTwoUpdates) {
  PaperLoop loop;
  std::uint64_t now_us = 1'000'000;
  for (int n = 0; n <= 40; ++n, now_us += kTickUs) {
    loop.take(force(n > 20 ? 2 : 0));
    const double x = loop.at(now_us).force_n.x;
    // The update of the ticks 21 to 30 is fetched in tick 30, and reached in tick 40.
    const double expected = n <= 30 ? 0 : 0.2 * (n - 30);
    EXPECT_NEAR(x, expected, 1e-12) << n;
  }
}

TEST(PaperLoop, IsZeroBeforeTheFirstUpdateAndRepeatsTheLastWithoutAnswers) {
  PaperLoop loop;
  std::uint64_t now_us = 1'000'000;
  for (int n = 0; n < 10; ++n, now_us += kTickUs) {
    loop.take(force(3));
    EXPECT_EQ(loop.at(now_us), Wrench{}) << n;
  }
  for (int n = 0; n < 100; ++n, now_us += kTickUs) loop.at(now_us);
  EXPECT_DOUBLE_EQ(loop.at(now_us).force_n.x, 3);
}

TEST(PaperLoop, KeepsItsRateWhenTicksAreEarlyAndStaysContinuousWhenSomeAreLost) {
  PaperLoop loop;
  double last = 0;
  double most = 0;
  for (std::uint64_t n = 0; n < 1000; ++n) {
    if (n % 97 > 90) continue;  // six ticks lost in a row
    const std::uint64_t jitter_us = n * 7919 % 400;
    loop.take(force(1 + std::sin(0.02 * static_cast<double>(n))));
    const double x = loop.at(1'000'000 + n * kTickUs + jitter_us).force_n.x;
    if (n > 30) most = std::max(most, std::abs(x - last));
    last = x;
  }
  // At most 0.02 N per tick; 0.15 over seven ticks and the jitter.
  EXPECT_LT(most, 0.16);
}

/// Moves along a line and holds the device.
class LineDevice final : public HapticDevice {
 public:
  DeviceCapabilities capabilities() const override { return {.max_force_n = 20}; }
  DeviceState read(std::uint64_t now_us) noexcept override {
    return {.tip_mm = {1e-5 * static_cast<double>(now_us), 0, 0},
            .buttons = wire::kButtonDeadman | wire::kButtonCutting,
            .time_us = now_us,
            .valid = true,
            .phase = DevicePhase::kReady};
  }
  void write(const Wrench& wrench) noexcept override { newest = wrench; }
  void stop() noexcept override {}
  Wrench newest{};
};

class NoListener final : public SampleListener {
 public:
  void sample_ready() noexcept override {}
};

TEST(PaperLoop, CycleInModePaperShowsTheReplicasForceOneUpdateLate) {
  LineDevice device;
  SampleRing samples;
  LatestValue<ServerWrench> wrenches;
  NoListener listener;
  ReplicaExchange replica;
  const ServoSettings settings =
      settings_for(device.capabilities(), {.mode = ForceMode::kPaper, .safety = {.motors = false}});
  ServoCycle cycle(device, samples, wrenches, listener, settings, &replica);
  TickTape tape;
  cycle.record_on(tape);
  // -1 N from 1 s on, increasing by 2 mN per tick, against the motion. The output stage does not
  // change it.
  const auto computed = [](std::uint64_t n) {
    return n < 1000 ? 0 : -1 - 0.002 * static_cast<double>(n - 1000);
  };
  for (std::uint64_t n = 1; n < 2000; ++n) {
    const ServerWrench answer{.wrench = {.force_n = {computed(n), 0, 0}, .torque_nmm = {}},
                              .pose_us = n * kTickUs,
                              .arrival_us = n * kTickUs};
    wrenches.write(answer);
    replica.write(answer);
    cycle.tick(n * kTickUs);
    TickRecord tick;
    ASSERT_TRUE(tape.pop(tick));
    EXPECT_EQ(tick.mode, ForceMode::kPaper);
    EXPECT_NEAR(tick.computed.force_n.x, computed(n), 1e-12) << "the answer itself";
    if (n > 1100) {
      EXPECT_NEAR(tick.requested.force_n.x, computed(n) + 0.029, 1e-9) << n;
    }
  }
  cycle.set_mode(ForceMode::kSilent);
  cycle.tick(2'000'000);
  TickRecord tick;
  ASSERT_TRUE(tape.pop(tick));
  EXPECT_EQ(tick.requested, Wrench{});
  EXPECT_EQ(tick.computed, Wrench{});
}

}  // namespace
}  // namespace kerf::agent::paper_loop_test
