// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/servo/servo_cycle.h"
#include "haptic_agent/servo/servo_loop.h"
#include "tests/support/test.h"

namespace kerf::agent::servo_test {
namespace {

constexpr std::uint64_t kMs = 1'000'000;

/// Simulated clock.
class FakeClock final : public Clock {
 public:
  std::uint64_t now_ns() noexcept override { return now_ns_; }
  void sleep_until_ns(std::uint64_t time_ns) noexcept override {
    now_ns_ = std::max(now_ns_, time_ns) + (wake_ < lateness_ns.size() ? lateness_ns[wake_] : 0);
    ++wake_;
  }
  void pass(std::uint64_t ns) { now_ns_ += ns; }
  /// Lateness of each wake-up.
  std::vector<std::uint64_t> lateness_ns;

 private:
  std::uint64_t now_ns_ = 500 * kMs;
  std::size_t wake_ = 0;
};

class Task final : public ServoTask {
 public:
  explicit Task(std::function<bool(std::uint64_t)> what) : what_(std::move(what)) {}
  bool tick(std::uint64_t now_us) noexcept override {
    times_us.push_back(now_us);
    return what_(now_us);
  }
  std::vector<std::uint64_t> times_us;

 private:
  std::function<bool(std::uint64_t)> what_;
};

TEST(ServoLoop, TicksEveryMillisecondWithoutDrift) {
  FakeClock clock;
  ServoLoop loop(clock);
  Task task([&](std::uint64_t) {
    clock.pass(300'000);
    return task.times_us.size() < 100;
  });
  loop.run(task);
  EXPECT_EQ(task.times_us.front(), 501'000U);
  EXPECT_EQ(task.times_us.back(), 600'000U);
  EXPECT_EQ(loop.stats().ticks, 100U);
  EXPECT_EQ(loop.stats().late, 0U);
  EXPECT_EQ(loop.stats().lost, 0U);
  EXPECT_EQ(loop.stats().longest_gap_us, 1000U);
  EXPECT_EQ(loop.stats().longest_tick_us, 300U);
}

TEST(ServoLoop, CountsLateAndLostTicksAndStaysInPhase) {
  FakeClock clock;
  clock.lateness_ns = {0, 400'000, 0, 5 * kMs + 100'000, 0};
  ServoLoop loop(clock);
  Task task([&](std::uint64_t) { return task.times_us.size() < 6; });
  loop.run(task);
  EXPECT_EQ(task.times_us,
            (std::vector<std::uint64_t>{501'000, 502'400, 503'000, 509'100, 510'000, 511'000}));
  EXPECT_EQ(loop.stats().ticks, 6U);
  EXPECT_EQ(loop.stats().late, 2U);
  EXPECT_EQ(loop.stats().lost, 5U) << "504 to 508 never ran";
  EXPECT_EQ(loop.stats().longest_gap_us, 6100U);
  EXPECT_EQ(loop.stats().wake_us.max_us(), 5100U);
}

TEST(ServoLoop, OverlongTickLosesTheOverrunTicks) {
  FakeClock clock;
  ServoLoop loop(clock);
  Task task([&](std::uint64_t) {
    if (task.times_us.size() == 1) clock.pass(3 * kMs + kMs / 2);
    return task.times_us.size() < 3;
  });
  loop.run(task);
  EXPECT_EQ(task.times_us, (std::vector<std::uint64_t>{501'000, 504'500, 505'000}));
  EXPECT_EQ(loop.stats().lost, 2U);
}

TEST(ServoLoop, StopsOnRequest) {
  FakeClock clock;
  ServoLoop loop(clock);
  Task task([&](std::uint64_t) {
    if (task.times_us.size() == 7) loop.stop();
    return true;
  });
  loop.run(task);
  EXPECT_EQ(loop.stats().ticks, 7U);
}

TEST(ServoLoop, ReportsHeartbeatAndLongestLoss) {
  FakeClock clock;
  clock.lateness_ns = {0, 2 * kMs + 1000, 0, 3 * kMs + 1000};
  ServoLoop loop(clock);
  EXPECT_EQ(loop.heartbeat_ns(), 0U);
  Task task([&](std::uint64_t now_us) {
    EXPECT_EQ(loop.heartbeat_ns() / 1000, now_us);
    return task.times_us.size() < 4;
  });
  loop.run(task);
  EXPECT_EQ(loop.stats().lost, 5U);
  EXPECT_EQ(loop.stats().most_lost_at_once, 3U);
}

class FakeDevice final : public HapticDevice {
 public:
  DeviceCapabilities capabilities() const override { return {.name = "fake"}; }
  DeviceState read(std::uint64_t now_us) noexcept override {
    state.time_us = now_us;
    return state;
  }
  void write(const Wrench& wrench) noexcept override { output = wrench; }
  void stop() noexcept override { output = {}; }
  DeviceState state{.valid = true, .phase = DevicePhase::kReady};
  Wrench output;
};

TEST(SettingsFor, TakesLimitsFromTheDeviceCapabilities) {
  const ServoSettings settings = settings_for({.max_force_n = 10,
                                               .max_torque_nmm = 200,
                                               .continuous_force_n = 3,
                                               .continuous_torque_nmm = 40,
                                               .max_stiffness_n_per_mm = 2,
                                               .max_damping_n_s_per_mm = 0.03,
                                               .max_vibration_hz = 120,
                                               .workspace_min_mm = {-1, -2, -3},
                                               .workspace_max_mm = {4, 5, 6}},
                                              {});
  EXPECT_DOUBLE_EQ(settings.limits.force_n, 6);
  EXPECT_DOUBLE_EQ(settings.limits.torque_nmm, 120);
  EXPECT_EQ(settings.safety.continuous_force_n, 3);
  EXPECT_EQ(settings.safety.continuous_torque_nmm, 40);
  EXPECT_EQ(settings.safety.workspace_min_mm, (Vec3{-1, -2, -3}));
  EXPECT_EQ(settings.safety.workspace_max_mm, (Vec3{4, 5, 6}));
  EXPECT_TRUE(settings.safety.motors);
  EXPECT_DOUBLE_EQ(settings.model.contact.max_stiffness, 2) << "stable_gains keeps the margins";
  EXPECT_DOUBLE_EQ(settings.model.max_damping, 0.015);
  EXPECT_EQ(settings.model.max_vibration_hz, 120);
}

TEST(SettingsFor, LimitsDampersByMassInertiaAndLatency) {
  const DeviceCapabilities light{.max_force_n = 10,
                                 .max_damping_n_s_per_mm = 0.06,
                                 .latency_us = 3000,
                                 .moving_mass_kg = 0.05,
                                 .moving_inertia_kg_m2 = 1e-5};
  const ServoSettings settings = settings_for(light, {});
  EXPECT_EQ(settings.passivity.latency_us, 3000U);
  EXPECT_EQ(settings.passivity.mass_kg, 0.05);
  EXPECT_EQ(settings.passivity.inertia_kg_m2, 1e-5);
  EXPECT_EQ(settings.passivity.longest_tick_us, 5000U) << "four lost ticks are tolerated";
  // A late damper oscillates above mass / delay. The filter depends on the mass at the tip.
  const double late_s = 0.004 + 1 / (1 / 0.05 + 0.06 * 0.06 / 1e-5) / 12.5;
  EXPECT_NEAR(settings.passivity.max_damping, 0.25 * 0.05 / late_s / 1000, 1e-6);
  EXPECT_NEAR(settings.passivity.max_turn_damping, 0.25 * 1e-5 / late_s * 1000, 1e-6);
  DeviceCapabilities heavy = light;
  heavy.moving_mass_kg = 5;
  heavy.moving_inertia_kg_m2 = 1;
  EXPECT_DOUBLE_EQ(settings_for(heavy, {}).passivity.max_damping, 0.03);
}

class Listener final : public SampleListener {
 public:
  void sample_ready() noexcept override { ++calls; }
  int calls = 0;
};

class ServoCycleTest : public ::testing::Test {
 protected:
  ServoCycle make(ServoSettings settings = {.mode = ForceMode::kInterpolated}) {
    return {device, samples, wrenches, listener, settings};
  }
  /// One tick of a device that moves down at 50 mm/s, against a force upwards.
  bool sink(ServoCycle& cycle, std::uint64_t now_us) {
    device.state.tip_mm.z -= 0.05;
    return cycle.tick(now_us);
  }
  void answer(double fz, std::uint64_t now_us) {
    wrenches.write({.wrench = {.force_n = {0, 0, fz}, .torque_nmm = {}},
                    .pose_us = now_us - 1000,
                    .arrival_us = now_us});
  }

  static constexpr Wrench kUpwards{.force_n = {0, 0, 2}, .torque_nmm = {}};
  FakeDevice device;
  SampleRing samples;
  LatestValue<ServerWrench> wrenches;
  Listener listener;
};

TEST_F(ServoCycleTest, PassesEachPoseToTheLink) {
  ServoCycle cycle = make({.tool_id = 4});
  device.state.tip_mm = {1, 2, 3};
  device.state.buttons = wire::kButtonCutting;
  EXPECT_TRUE(cycle.tick(10'000));
  device.state.tool_id = 9;
  EXPECT_TRUE(cycle.tick(11'000));
  wire::MotionSample sample;
  ASSERT_TRUE(samples.pop(sample));
  EXPECT_EQ(sample.time_us, 10'000U);
  EXPECT_EQ(sample.tip_mm, (Vec3{1, 2, 3}));
  EXPECT_EQ(sample.tool_id, 4U);
  EXPECT_EQ(sample.buttons, wire::kButtonCutting);
  ASSERT_TRUE(samples.pop(sample));
  EXPECT_EQ(sample.tool_id, 9U) << "the device's tool takes precedence";
  EXPECT_EQ(listener.calls, 2);
}

TEST_F(ServoCycleTest, WakesTheLinkLessOftenWhileTheReplicaAnswers) {
  ReplicaExchange replica;
  ServoCycle cycle(device, samples, wrenches, listener, {.mode = ForceMode::kModel}, &replica);
  std::uint64_t now_us = 10'000;
  const auto tick = [&](bool answered) {
    if (answered) replica.write({.pose_us = now_us - 1000, .arrival_us = now_us});
    EXPECT_TRUE(cycle.tick(now_us));
    now_us += 1000;
  };
  for (int i = 0; i < 8; ++i) tick(false);
  EXPECT_EQ(listener.calls, 8);
  for (int i = 0; i < 41; ++i) tick(true);
  EXPECT_EQ(listener.calls, 8 + 1 + 40 / kSamplesPerWake) << "one before the first answer is read";
  device.state.buttons = wire::kButtonCutting;
  const int before = listener.calls;
  tick(true);
  EXPECT_EQ(listener.calls, before + 1) << "a button is sent at once";
  // The replica falls silent, so the server's answers are needed again.
  for (int i = 0; i < 8; ++i) tick(false);
  const int silent = listener.calls;
  for (int i = 0; i < 8; ++i) tick(false);
  EXPECT_EQ(listener.calls, silent + 8);
  wire::MotionSample sample;
  int sent = 0;
  while (samples.pop(sample)) ++sent;
  EXPECT_EQ(sent, 8 + 41 + 1 + 16) << "no sample is left out";
}

TEST_F(ServoCycleTest, WakesTheReplicaForEverySecondSampleUnlessMillingOrTurning) {
  for (const CutLaw law : {CutLaw::kSpecificEnergy, CutLaw::kMechanistic}) {
    ReplicaExchange replica;
    ServoCycle cycle(device, samples, wrenches, listener, {.model = {.law = law}}, &replica);
    int wakes = 0, popped = 0;
    for (int i = 0; i < 20; ++i) {
      device.state.tip_mm.z -= 0.05;
      EXPECT_TRUE(cycle.tick(10'000 + 1000 * static_cast<std::uint64_t>(i)));
      if (!replica.is_woken()) continue;
      replica.wait();
      ++wakes;
      wire::MotionSample sample;
      while (replica.pop(sample)) ++popped;
    }
    EXPECT_EQ(wakes, law == CutLaw::kMechanistic ? 20 : 10);
    EXPECT_EQ(popped, 20);
    for (int i = 20; i < 24; ++i) {
      // The first tick of a corner contains only a part of the turn, here 35 degrees.
      device.state.tip_mm.y -= i == 20 ? 0.035 : 0.05;
      if (i == 20) device.state.tip_mm.z -= 0.05;
      EXPECT_TRUE(cycle.tick(10'000 + 1000 * static_cast<std::uint64_t>(i)));
      ASSERT_TRUE(replica.is_woken()) << "at a corner";
      replica.wait();
    }
  }
}

TEST_F(ServoCycleTest, RendersTheServersForceAndFadesItWhenTheServerIsSilent) {
  ServoCycle cycle = make();
  std::uint64_t now_us = 10'000;
  for (int i = 0; i < 200; ++i, now_us += 1000) {
    answer(2.0, now_us);
    sink(cycle, now_us);
  }
  EXPECT_NEAR(device.output.force_n.z, 2.0, 1e-12);
  const std::uint64_t silent_from_us = now_us - 1000;
  double last = device.output.force_n.z;
  for (; now_us < silent_from_us + 200'000; now_us += 1000) {
    sink(cycle, now_us);
    const double output = device.output.force_n.z;
    EXPECT_LE(output, last);
    last = output;
    if (now_us <= silent_from_us + 20'000) {
      EXPECT_NEAR(output, 2.0, 1e-12);
    }
    if (now_us >= silent_from_us + 120'000) {
      EXPECT_EQ(output, 0.0);
    }
  }
  EXPECT_GT(cycle.report().decayed_ticks, 90U);
  EXPECT_NEAR(cycle.report().max_force_n, 2.0, 1e-12);
}

TEST_F(ServoCycleTest, FollowedWrenchIsSmoothedAndFaded) {
  for (const ForceMode mode : {ForceMode::kModel, ForceMode::kInterpolated, ForceMode::kHold}) {
    // A device so heavy that the small energy of the first ticks suffices.
    ServoCycle cycle = make({.mode = mode, .passivity = {.mass_kg = 1}});
    std::uint64_t now_us = 10'000;
    const auto feel = [&](int ticks) {
      for (int i = 0; i < ticks; ++i, now_us += 1000) {
        wrenches.write({.pose_us = now_us, .arrival_us = now_us, .felt = kUpwards});
        sink(cycle, now_us);
      }
      return device.output.force_n.z;
    };
    EXPECT_LT(feel(3), 0.6) << "the first tenth of a step";
    EXPECT_NEAR(feel(7), 2 * (1 - std::exp(-1.0)), 0.1) << "after its time constant";
    EXPECT_NEAR(feel(90), 2, 0.01);
    const std::uint64_t silent_from_us = now_us;
    for (; now_us < silent_from_us + 60'000; now_us += 1000) sink(cycle, now_us);
    EXPECT_NEAR(device.output.force_n.z, 2 * std::exp(-1.0), 0.1);
    for (; now_us < silent_from_us + 121'000; now_us += 1000) sink(cycle, now_us);
    EXPECT_EQ(device.output, Wrench{});
  }
}

TEST_F(ServoCycleTest, FollowedWrenchIsLimitedByTheEnergyTank) {
  ServoCycle cycle = make({.mode = ForceMode::kModel, .passivity = {.start_mj = 0}});
  std::uint64_t now_us = 10'000;
  const auto rest = [&](double move_mm) {
    for (int i = 0; i < 200; ++i, now_us += 1000) {
      wrenches.write({.pose_us = now_us, .arrival_us = now_us, .felt = kUpwards});
      device.state.tip_mm.z += move_mm;
      cycle.tick(now_us);
    }
    return device.output.force_n.z;
  };
  EXPECT_EQ(rest(0), 0) << "no force at rest while the tank is empty";
  rest(-0.05);
  EXPECT_NEAR(rest(0), 2, 0.01);
  EXPECT_LT(rest(0.05), 0.1) << "the 18 mJ of the account are spent after 9 mm";
  EXPECT_LT(cycle.passivity().account().most_returned_mj(), 30);
}

TEST_F(ServoCycleTest, InvalidPoseIsNotSentAndGivesNoForce) {
  ServoCycle cycle = make();
  std::uint64_t now_us = 10'000;
  for (int i = 0; i < 100; ++i, now_us += 1000) {
    answer(2.0, now_us);
    sink(cycle, now_us);
  }
  wire::MotionSample sample;
  while (samples.pop(sample)) {
  }
  const auto expect_rejected = [&] {
    answer(2.0, now_us);
    cycle.tick(now_us += 1000);
    EXPECT_FALSE(samples.pop(sample));
    EXPECT_EQ(device.output, Wrench{});
  };
  device.state.tip_mm.y = std::numeric_limits<double>::quiet_NaN();
  expect_rejected();
  device.state.tip_mm.y = 0;
  device.state.axis = {0, 0, 0.9};
  expect_rejected();
  device.state.axis = {0, std::numeric_limits<double>::infinity(), 1};
  expect_rejected();
  device.state = {};
  expect_rejected();
  EXPECT_EQ(cycle.report().invalid_poses, 4U);
}

TEST_F(ServoCycleTest, EndsWithZeroForce) {
  ServoCycle cycle = make({.duration_us = 50'000, .mode = ForceMode::kInterpolated});
  std::uint64_t now_us = 10'000;
  bool more = true;
  while (more && now_us < 1'000'000) {
    answer(3.0, now_us);
    more = sink(cycle, now_us);
    now_us += 1000;
  }
  EXPECT_EQ(now_us, 61'000U);
  EXPECT_EQ(device.output, Wrench{});
  EXPECT_GT(cycle.report().max_force_n, 0);
}

TEST_F(ServoCycleTest, FullRingDropsAndCountsSamples) {
  ServoCycle cycle = make();
  for (std::size_t i = 0; i < SampleRing::kCapacity + 5; ++i) cycle.tick(10'000 + 1000 * i);
  EXPECT_EQ(cycle.report().samples, SampleRing::kCapacity);
  EXPECT_EQ(cycle.report().ring_overflows, 5U);
}

TEST_F(ServoCycleTest, EndsAfterTheDevicesLastPose) {
  ServoCycle cycle = make();
  EXPECT_TRUE(cycle.tick(10'000));
  device.state.finished = true;
  EXPECT_FALSE(cycle.tick(11'000));
  EXPECT_EQ(cycle.report().samples, 2U);
}

}  // namespace
}  // namespace kerf::agent::servo_test
