// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/device/simulated_hand.h"

#include "haptic_agent/device/replay.h"
#include "server/wire/types.h"
#include "tests/support/test.h"

namespace kerf::agent::simulated_hand_test {
namespace {

const PoseScript kLine = {{.time_s = 0, .tip_mm = {0, 0, 0}, .cutting = false},
                          {.time_s = 1, .tip_mm = {50, 0, 0}, .cutting = true}};

/// Runs a device at 1 kHz for a time. Writes a wrench before each tick.
DeviceState run(HapticDevice& device, std::uint64_t from_us, double for_s,
                const std::function<Wrench(const DeviceState&)>& wrench) {
  DeviceState state = device.read(from_us);
  const auto ticks = static_cast<std::uint64_t>(for_s * 1000);
  for (std::uint64_t i = 1; i <= ticks; ++i) {
    device.write(wrench(state));
    state = device.read(from_us + 1000 * i);
  }
  return state;
}

Wrench nothing(const DeviceState&) { return {}; }

TEST(SimulatedHand, FollowsItsPathWithoutForce) {
  SimulatedHand hand(PathCursor(kLine, false), {});
  double worst_mm = 0;
  run(hand, 1000, 0.9, [&](const DeviceState& state) {
    worst_mm = std::max(worst_mm, std::hypot(state.tip_mm.y, state.tip_mm.z));
    return Wrench{};
  });
  EXPECT_LT(worst_mm, 1e-9);
  // The path starts at full speed, which the mass reaches with a delay.
  EXPECT_NEAR(run(hand, 901'000, 0.05, nothing).tip_mm.x, 47.5, 0.05);
}

TEST(SimulatedHand, DeflectionIsForceOverStiffness) {
  const HandSettings settings{.stiffness_n_per_mm = 2.0};
  SimulatedHand hand(PathCursor(kLine, false), settings);
  const DeviceState state = run(hand, 1000, 0.8, [](const DeviceState&) {
    return Wrench{.force_n = {0, 4, 0}, .torque_nmm = {}};
  });
  EXPECT_NEAR(state.tip_mm.y, 2.0, 1e-3);
  EXPECT_GT(hand.max_deviation_mm(), 1.9);
}

TEST(SimulatedHand, StopClearsTheForceUntilTheNextWrite) {
  SimulatedHand hand(PathCursor(kLine, false), {});
  const Wrench push{.force_n = {0, 4, 0}, .torque_nmm = {}};
  std::uint64_t now_us = 1000;
  const auto advance = [&](int ticks) {
    DeviceState state;
    for (int i = 0; i < ticks; ++i) state = hand.read(now_us += 1000);
    return state;
  };
  hand.write(push);
  EXPECT_NEAR(advance(300).tip_mm.y, 2.0, 0.01);
  hand.stop();
  EXPECT_NEAR(advance(300).tip_mm.y, 0.0, 0.01);
  hand.write(push);
  EXPECT_NEAR(advance(300).tip_mm.y, 2.0, 0.01);
}

TEST(SimulatedHand, IsAlwaysReadyLikeReplay) {
  SimulatedHand hand(PathCursor(kLine, false), {});
  Replay replay(PathCursor(kLine, false));
  EXPECT_EQ(hand.read(0).phase, DevicePhase::kReady);
  EXPECT_EQ(replay.read(0).phase, DevicePhase::kReady);
}

TEST(SimulatedHand, ResistanceDelaysIt) {
  SimulatedHand free_hand(PathCursor(kLine, false), {});
  SimulatedHand cutting_hand(PathCursor(kLine, false), {});
  const DeviceState free_state = run(free_hand, 1000, 0.5, nothing);
  const DeviceState held = run(cutting_hand, 1000, 0.5, [](const DeviceState&) {
    return Wrench{.force_n = {-6, 0, 0}, .torque_nmm = {}};
  });
  EXPECT_NEAR(free_state.tip_mm.x - held.tip_mm.x, 3.0, 0.05);
}

TEST(SimulatedHand, TorqueRotatesTheToolAboutThePivot) {
  const HandSettings settings{.turn_stiffness_nmm_per_rad = 1000, .pivot_mm = 60};
  SimulatedHand hand(PathCursor({{.tip_mm = {0, 0, 0}}, {.time_s = 10}}, false), settings);
  const DeviceState state = run(hand, 1000, 1.0, [](const DeviceState&) {
    return Wrench{.force_n = {}, .torque_nmm = {0, 100, 0}};
  });
  EXPECT_NEAR(std::asin(state.axis.x), std::asin(0.1), 1e-3);
  EXPECT_NEAR(state.tip_mm.x, -6.0, 0.05)
      << "the pivot stays, so the tip moves in the opposite direction";
  EXPECT_NEAR(length(state.axis), 1.0, 1e-12);
}

TEST(SimulatedHand, TorqueAboutTheToolAxisHasNoEffect) {
  SimulatedHand hand(PathCursor({{.tip_mm = {0, 0, 0}}, {.time_s = 10}}, false), {});
  const DeviceState state = run(hand, 1000, 1.0, [](const DeviceState&) {
    return Wrench{.force_n = {}, .torque_nmm = {0, 0, 150}};
  });
  EXPECT_EQ(state.axis, (Vec3{0, 0, 1}));
}

TEST(SimulatedHand, DoesNotMoveDuringAPauseOfTheLoop) {
  SimulatedHand hand(PathCursor(kLine, false), {});
  run(hand, 1000, 0.2, nothing);
  const double before_mm = hand.read(201'000).tip_mm.x;
  const double after_mm = hand.read(5'201'000).tip_mm.x;
  EXPECT_LT(after_mm - before_mm, 5.0) << "a pause of five seconds is not simulated";
}

TEST(SimulatedHand, FinishesAfterResting) {
  SimulatedHand hand(PathCursor(kLine, false), {});
  EXPECT_FALSE(run(hand, 1000, 1.2, nothing).finished);
  EXPECT_TRUE(run(hand, 1'201'000, 0.2, nothing).finished);
}

TEST(Replay, PlaysPosesAtTheirTimesRegardlessOfForce) {
  Replay replay(PathCursor(kLine, false));
  EXPECT_EQ(replay.read(7'000'000).tip_mm, (Vec3{0, 0, 0}));
  replay.write({.force_n = {100, 100, 100}, .torque_nmm = {}});
  const DeviceState state = replay.read(7'500'000);
  EXPECT_EQ(state.tip_mm, (Vec3{25, 0, 0}));
  EXPECT_EQ(state.buttons, wire::kButtonDeadman | wire::kButtonCutting);
  EXPECT_FALSE(state.finished);
  EXPECT_TRUE(replay.read(8'000'000).finished);
  EXPECT_EQ(replay.read(8'000'000).tip_mm, (Vec3{50, 0, 0}));
}

}  // namespace
}  // namespace kerf::agent::simulated_hand_test
