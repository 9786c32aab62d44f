// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <limits>
#include <memory>
#include <thread>

#include "haptic_agent/servo/servo_cycle.h"
#include "haptic_agent/servo/watchdog.h"

namespace kerf::agent {
namespace {

constexpr std::uint64_t kMs = 1000;

class Motors final : public HapticDevice {
 public:
  DeviceCapabilities capabilities() const override {
    return {.name = "motors", .max_force_n = 20, .max_torque_nmm = 500, .has_deadman = true};
  }
  DeviceState read(std::uint64_t now_us) noexcept override {
    state.time_us = now_us;
    return state;
  }
  void write(const Wrench& wrench) noexcept override { shown = wrench; }
  void stop() noexcept override { ++stops; }
  DeviceState state{.buttons = wire::kButtonDeadman, .valid = true, .phase = DevicePhase::kReady};
  Wrench shown;
  std::atomic<int> stops{0};
};

class Nobody final : public SampleListener {
 public:
  void sample_ready() noexcept override {}
};

/// A hand that goes down at 50 mm/s against 2 N upwards, on a clock that the test holds.
class Safety : public ::testing::Test {
 protected:
  Safety() {
    ServoSettings settings = settings_for(device.capabilities(), {});
    settings.mode = ForceMode::kInterpolated;
    cycle = std::make_unique<ServoCycle>(device, samples, wrenches, nobody, settings);
  }
  void tick(bool answered = true, double newtons = 2, std::uint64_t passed_us = kMs) {
    now_us += passed_us;
    if (moving) device.state.tip_mm.z -= 0.04;
    if (answered) {
      wrenches.write({.wrench = {.force_n = {0, 0, newtons}, .torque_nmm = {}},
                      .pose_us = now_us - 1000,
                      .arrival_us = now_us});
    }
    wire::MotionSample sample;
    cycle->tick(now_us);
    while (samples.pop(sample)) {
    }
  }
  void activate() {
    moving = false;
    for (int i = 0; i < 700; ++i) tick(true, 0);
    moving = true;
    for (int i = 0; i < 200; ++i) tick();
    ASSERT_EQ(cycle->supervisor().phase(), ServoPhase::kActive);
    ASSERT_NEAR(device.shown.force_n.z, 2, 1e-9);
  }
  /// ms from what `event` does to no force; -1: never.
  template <typename Event>
  int ms_to_silence(Event event, bool answered) {
    event();
    for (int ms = 1; ms <= 1000; ++ms) {
      tick(answered);
      if (device.shown == Wrench{}) return ms;
    }
    return -1;
  }

  Motors device;
  SampleRing samples;
  LatestValue<ServerWrench> wrenches;
  Nobody nobody;
  std::unique_ptr<ServoCycle> cycle;
  std::uint64_t now_us = 1'000'000;
  bool moving = true;
};

TEST_F(Safety, ShowsNothingBeforeItIsArmed) {
  for (int i = 0; i < 1000; ++i) {
    tick();
    ASSERT_EQ(device.shown, Wrench{}) << "2 N are no way to begin";
  }
  EXPECT_EQ(cycle->supervisor().phase(), ServoPhase::kArmed);
}

TEST_F(Safety, LosingTheServerEndsTheForceWithin150Ms) {
  activate();
  const int ms = ms_to_silence([] {}, false);
  EXPECT_GT(ms, 20);
  EXPECT_LE(ms, 150);
}

/// A hand that cuts its way down, answered by a copy of the block after each tick, and by the
/// server 100 ms later.
class SafetyNear : public Safety {
 protected:
  SafetyNear() {
    device.state.buttons |= wire::kButtonCutting;
    cycle = std::make_unique<ServoCycle>(device, samples, wrenches, nobody,
                                         settings_for(device.capabilities(), {}), &near);
  }
  static ServerWrench cut(double newtons, std::uint64_t pose_us, std::uint64_t arrival_us) {
    return {.wrench = {.force_n = {0, 0, newtons}, .torque_nmm = {}},
            .pose_us = pose_us,
            .arrival_us = arrival_us,
            .engaged_area_mm2 = newtons};
  }
  void tick_near(bool copy, bool server, double copy_n = 2, double server_n = 2) {
    if (server) wrenches.write(cut(server_n, now_us - 100 * kMs, now_us));
    tick(false);
    wire::MotionSample sample;
    while (near.pop(sample)) {
      if (copy) near.write(cut(copy_n, sample.time_us, now_us));
    }
  }
  void activate_near() {
    moving = false;
    for (int i = 0; i < 700; ++i) tick_near(true, true, 0, 0);
    moving = true;
    for (int i = 0; i < 300; ++i) tick_near(true, true, 2, 1);
    ASSERT_EQ(cycle->supervisor().phase(), ServoPhase::kActive);
  }

  NearAnswers near;
};

TEST_F(SafetyNear, TheNewerPosesAnswerIsFelt) {
  activate_near();
  EXPECT_NEAR(device.shown.force_n.z, 2, 0.05) << "not the 1 N of 100 ms ago";
}

TEST_F(SafetyNear, AnOldAnswerThatComesBetweenTwoOfTheCopyIsNotFelt) {
  activate_near();
  for (int ms = 0; ms < 50; ++ms) {
    tick_near(ms % 4 == 0, true, 2, 1);
    EXPECT_NEAR(device.shown.force_n.z, 2, 0.05) << ms;
  }
}

TEST_F(SafetyNear, LosingTheServerEndsTheForceWithin150MsThoughTheCopyGoesOn) {
  activate_near();
  int ms = 0;
  for (; ms < 1000 && device.shown != Wrench{}; ++ms) tick_near(true, false);
  EXPECT_GT(ms, 100);
  EXPECT_LE(ms, 150);
}

TEST_F(SafetyNear, AStallOfTheServerUpToATenthOfASecondIsNotFelt) {
  activate_near();
  for (int ms = 0; ms < 98; ++ms) {
    tick_near(true, false);
    ASSERT_NEAR(device.shown.force_n.z, 2, 0.05) << ms;
  }
  EXPECT_EQ(cycle->supervisor().phase(), ServoPhase::kActive);
}

TEST_F(SafetyNear, ACopyThatFallsSilentLeavesTheServersAnswers) {
  activate_near();
  for (int ms = 0; ms < 400; ++ms) tick_near(false, true, 0, 1);
  EXPECT_NEAR(device.shown.force_n.z, 1, 0.05);
}

TEST_F(SafetyNear, WithoutEitherTheForceEndsAsSoonAsWithoutACopy) {
  activate_near();
  int ms = 0;
  for (; ms < 1000 && device.shown != Wrench{}; ++ms) tick_near(false, false);
  EXPECT_LE(ms, 125);
}

TEST_F(Safety, LettingGoEndsItInTheNextTick) {
  activate();
  EXPECT_EQ(ms_to_silence([&] { device.state.buttons = 0; }, true), 1);
}

TEST_F(Safety, UnpluggingEndsItInTheNextTick) {
  activate();
  EXPECT_EQ(ms_to_silence([&] { device.state = {}; }, true), 1);
  EXPECT_EQ(cycle->supervisor().code(), TripCode::kDeviceLost);
}

TEST_F(Safety, AJumpEndsItInTheNextTickAndIsLogged) {
  activate();
  EXPECT_EQ(ms_to_silence([&] { device.state.tip_mm.x += 8; }, true), 1);
  EXPECT_EQ(cycle->supervisor().code(), TripCode::kJump);
  const FlightLog* log = cycle->recorder().log();
  ASSERT_NE(log, nullptr);
  EXPECT_EQ(log->code, TripCode::kJump);
  ASSERT_EQ(log->count, FlightLog::kTicks);
  EXPECT_EQ(log->ticks.back().time_us, now_us);
  EXPECT_EQ(log->ticks.back().shown, Wrench{});
  EXPECT_NEAR(log->ticks[100].shown.force_n.z, 2, 1e-9);
  cycle->recorder().done();
  EXPECT_EQ(cycle->recorder().log(), nullptr);
}

TEST_F(Safety, ALoopThatStoodStillTripsWhenItComesBack) {
  activate();
  tick(true, 2, 30 * kMs);
  EXPECT_EQ(device.shown, Wrench{});
  EXPECT_EQ(cycle->supervisor().code(), TripCode::kLostTicksInARow);
}

TEST_F(Safety, AServerThatComesBackBringsNoJump) {
  activate();
  for (int i = 0; i < 1500; ++i) tick(false);
  moving = false;
  for (int i = 0; i < 100; ++i) tick(true, 0);
  moving = true;
  double before = 0;
  for (int i = 0; i < 800; ++i) {
    tick();
    EXPECT_LE(device.shown.force_n.z - before, 0.5) << i;
    before = device.shown.force_n.z;
  }
  EXPECT_NEAR(before, 2, 1e-9);
}

TEST_F(Safety, AWrenchThatIsNoNumberTrips) {
  activate();
  tick(true, std::numeric_limits<double>::quiet_NaN());
  tick(true, std::numeric_limits<double>::quiet_NaN());
  EXPECT_EQ(device.shown, Wrench{});
  EXPECT_EQ(cycle->supervisor().code(), TripCode::kRejectedWrench);
}

class OnDemand final : public ServoClock {
 public:
  std::uint64_t now_ns() noexcept override { return time_ns; }
  void sleep_until_ns(std::uint64_t until_ns) noexcept override { time_ns = until_ns; }
  std::uint64_t time_ns = 1'000'000'000;
};

TEST(Watchdog, StopsADeviceWhoseLoopStandsStill) {
  OnDemand clock;
  ServoLoop loop(clock);
  int stops = 0;
  Watchdog watchdog(loop, [&] { ++stops; });
  EXPECT_FALSE(watchdog.look(clock.time_ns)) << "a loop that has not begun shows no force";
  struct Once final : ServoTask {
    bool tick(std::uint64_t) noexcept override { return false; }
  } once;
  loop.run(once);
  EXPECT_FALSE(watchdog.look(clock.time_ns + Watchdog::kStaleNs));
  EXPECT_TRUE(watchdog.look(clock.time_ns + Watchdog::kStaleNs + 1));
  EXPECT_TRUE(watchdog.look(clock.time_ns + 2 * Watchdog::kStaleNs));
  EXPECT_EQ(stops, 2);
  EXPECT_EQ(watchdog.stops(), 1U) << "one standstill";
  static_assert(Watchdog::kStaleNs + Watchdog::kEveryNs <= 15'000'000, "as the README promises");
}

TEST(Watchdog, DoesSoFromAThreadOfItsOwn) {
  MonotonicClock clock;
  ServoLoop loop(clock);
  Motors device;
  Watchdog watchdog(loop, [&] { device.stop(); });
  std::atomic<bool> frozen{true};
  struct Freeze final : ServoTask {
    std::atomic<bool>& frozen;
    explicit Freeze(std::atomic<bool>& f) : frozen(f) {}
    bool tick(std::uint64_t) noexcept override {
      frozen.wait(true);
      return false;
    }
  } task(frozen);
  watchdog.start();
  std::thread servo([&] { loop.run(task); });
  while (device.stops == 0) std::this_thread::yield();
  frozen = false;
  frozen.notify_all();
  servo.join();
  watchdog.end();
  EXPECT_EQ(watchdog.stops(), 1U);
}

}  // namespace
}  // namespace kerf::agent
