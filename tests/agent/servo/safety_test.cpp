// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/servo/servo_cycle.h"
#include "haptic_agent/servo/watchdog.h"
#include "tests/support/test.h"

namespace kerf::agent::safety_test {
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
  void write(const Wrench& wrench) noexcept override { output = wrench; }
  void stop() noexcept override { ++stops; }
  DeviceState state{.buttons = wire::kButtonDeadman, .valid = true, .phase = DevicePhase::kReady};
  Wrench output;
  std::atomic<int> stops{0};
};

class NoListener final : public SampleListener {
 public:
  void sample_ready() noexcept override {}
};

/// A device that moves down at 40 mm/s against 2 N upwards, on a simulated clock.
class Safety : public ::testing::Test {
 protected:
  Safety() {
    ServoSettings settings = settings_for(device.capabilities(), {});
    settings.mode = ForceMode::kInterpolated;
    cycle = std::make_unique<ServoCycle>(device, samples, wrenches, listener, settings);
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
    ASSERT_NEAR(device.output.force_n.z, 2, 1e-9);
  }
  /// Returns the time from `event` to zero force, ms, or -1 if the force stays.
  template <typename Event>
  int ms_to_zero_force(Event event, bool answered) {
    event();
    for (int ms = 1; ms <= 1000; ++ms) {
      tick(answered);
      if (device.output == Wrench{}) return ms;
    }
    return -1;
  }

  Motors device;
  SampleRing samples;
  LatestValue<ServerWrench> wrenches;
  NoListener listener;
  std::unique_ptr<ServoCycle> cycle;
  std::uint64_t now_us = 1'000'000;
  bool moving = true;
};

TEST_F(Safety, OutputIsZeroBeforeArming) {
  for (int i = 0; i < 1000; ++i) {
    tick();
    ASSERT_EQ(device.output, Wrench{}) << "2 N are too much for arming";
  }
  EXPECT_EQ(cycle->supervisor().phase(), ServoPhase::kArmed);
}

TEST_F(Safety, ServerLossEndsTheForceWithin150Ms) {
  activate();
  const int ms = ms_to_zero_force([] {}, false);
  EXPECT_GT(ms, 20);
  EXPECT_LE(ms, 150);
}

/// A device that cuts downwards, answered by a replica after each tick and by the server 100 ms
/// later.
class SafetyWithReplica : public Safety {
 protected:
  SafetyWithReplica() {
    device.state.buttons |= wire::kButtonCutting;
    cycle = std::make_unique<ServoCycle>(device, samples, wrenches, listener,
                                         settings_for(device.capabilities(), {}), &exchange);
  }
  static ServerWrench cut(double newtons, std::uint64_t pose_us, std::uint64_t arrival_us) {
    return {.wrench = {.force_n = {0, 0, newtons}, .torque_nmm = {}},
            .pose_us = pose_us,
            .arrival_us = arrival_us,
            .engaged_area_mm2 = newtons};
  }
  void tick_replica(bool replica, bool server, double replica_n = 2, double server_n = 2) {
    if (server) wrenches.write(cut(server_n, now_us - 100 * kMs, now_us));
    tick(false);
    wire::MotionSample sample;
    while (exchange.pop(sample)) {
      if (replica) exchange.write(cut(replica_n, sample.time_us, now_us));
    }
  }
  void activate_replica() {
    moving = false;
    for (int i = 0; i < 700; ++i) tick_replica(true, true, 0, 0);
    moving = true;
    for (int i = 0; i < 300; ++i) tick_replica(true, true, 2, 1);
    ASSERT_EQ(cycle->supervisor().phase(), ServoPhase::kActive);
  }

  ReplicaExchange exchange;
};

TEST_F(SafetyWithReplica, AnswerToTheNewerPoseIsRendered) {
  activate_replica();
  EXPECT_NEAR(device.output.force_n.z, 2, 0.05) << "not the 1 N of 100 ms ago";
}

TEST_F(SafetyWithReplica, OldServerAnswerBetweenReplicaAnswersIsIgnored) {
  activate_replica();
  for (int ms = 0; ms < 50; ++ms) {
    tick_replica(ms % 4 == 0, true, 2, 1);
    EXPECT_NEAR(device.output.force_n.z, 2, 0.05) << ms;
  }
}

TEST_F(SafetyWithReplica, ServerLossEndsTheForceWithin150MsDespiteTheReplica) {
  activate_replica();
  int ms = 0;
  for (; ms < 1000 && device.output != Wrench{}; ++ms) tick_replica(true, false);
  EXPECT_GT(ms, 100);
  EXPECT_LE(ms, 150);
}

TEST_F(SafetyWithReplica, ReplicaMasksServerStallsUpTo100Ms) {
  activate_replica();
  for (int ms = 0; ms < 98; ++ms) {
    tick_replica(true, false);
    ASSERT_NEAR(device.output.force_n.z, 2, 0.05) << ms;
  }
  EXPECT_EQ(cycle->supervisor().phase(), ServoPhase::kActive);
}

TEST_F(SafetyWithReplica, ServerAnswersAreRenderedWithoutReplicaAnswers) {
  activate_replica();
  for (int ms = 0; ms < 400; ++ms) tick_replica(false, true, 0, 1);
  EXPECT_NEAR(device.output.force_n.z, 1, 0.05);
}

TEST_F(SafetyWithReplica, WithoutAnyAnswersTheForceEndsAsWithoutAReplica) {
  activate_replica();
  int ms = 0;
  for (; ms < 1000 && device.output != Wrench{}; ++ms) tick_replica(false, false);
  EXPECT_LE(ms, 125);
}

TEST_F(Safety, ReleasingTheDeadmanEndsTheForceInTheNextTick) {
  activate();
  EXPECT_EQ(ms_to_zero_force([&] { device.state.buttons = 0; }, true), 1);
}

TEST_F(Safety, UnpluggingEndsTheForceInTheNextTick) {
  activate();
  EXPECT_EQ(ms_to_zero_force([&] { device.state = {}; }, true), 1);
  EXPECT_EQ(cycle->supervisor().code(), TripCode::kDeviceLost);
}

TEST_F(Safety, JumpTripsInTheNextTickAndIsLogged) {
  activate();
  EXPECT_EQ(ms_to_zero_force([&] { device.state.tip_mm.x += 8; }, true), 1);
  EXPECT_EQ(cycle->supervisor().code(), TripCode::kJump);
  const FlightLog* log = cycle->recorder().log();
  ASSERT_NE(log, nullptr);
  EXPECT_EQ(log->code, TripCode::kJump);
  ASSERT_EQ(log->count, FlightLog::kTicks);
  EXPECT_EQ(log->ticks.back().time_us, now_us);
  EXPECT_EQ(log->ticks.back().output, Wrench{});
  EXPECT_NEAR(log->ticks[100].output.force_n.z, 2, 1e-9);
  cycle->recorder().done();
  EXPECT_EQ(cycle->recorder().log(), nullptr);
}

TEST_F(Safety, StalledLoopTripsWhenItResumes) {
  activate();
  tick(true, 2, 30 * kMs);
  EXPECT_EQ(device.output, Wrench{});
  EXPECT_EQ(cycle->supervisor().code(), TripCode::kLostTicksInARow);
}

TEST_F(Safety, ReturningServerCausesNoForceStep) {
  activate();
  for (int i = 0; i < 1500; ++i) tick(false);
  moving = false;
  for (int i = 0; i < 100; ++i) tick(true, 0);
  moving = true;
  double before = 0;
  for (int i = 0; i < 800; ++i) {
    tick();
    EXPECT_LE(device.output.force_n.z - before, 0.5) << i;
    before = device.output.force_n.z;
  }
  EXPECT_NEAR(before, 2, 1e-9);
}

TEST_F(Safety, NonFiniteWrenchTrips) {
  activate();
  tick(true, std::numeric_limits<double>::quiet_NaN());
  tick(true, std::numeric_limits<double>::quiet_NaN());
  EXPECT_EQ(device.output, Wrench{});
  EXPECT_EQ(cycle->supervisor().code(), TripCode::kRejectedWrench);
}

class ManualClock final : public Clock {
 public:
  std::uint64_t now_ns() noexcept override { return time_ns; }
  void sleep_until_ns(std::uint64_t until_ns) noexcept override { time_ns = until_ns; }
  std::uint64_t time_ns = 1'000'000'000;
};

TEST(Watchdog, StopsTheDeviceWhenTheLoopStalls) {
  ManualClock clock;
  ServoLoop loop(clock);
  int stops = 0;
  Watchdog watchdog(loop, [&] { ++stops; });
  EXPECT_FALSE(watchdog.check(clock.time_ns)) << "a loop that has not started outputs no force";
  struct Once final : ServoTask {
    bool tick(std::uint64_t) noexcept override { return false; }
  } once;
  loop.run(once);
  EXPECT_FALSE(watchdog.check(clock.time_ns + ServoLoop::kStaleNs - 1));
  EXPECT_TRUE(watchdog.check(clock.time_ns + ServoLoop::kStaleNs));
  EXPECT_TRUE(watchdog.check(clock.time_ns + 2 * ServoLoop::kStaleNs));
  EXPECT_EQ(stops, 2);
  EXPECT_EQ(watchdog.stops(), 1U) << "one stall";
  static_assert(ServoLoop::kStaleNs <= 10'000'000, "documented in the README");
}

TEST(Watchdog, MotorsAreOffAfterAnyEndOfTheLoop) {
  for (const bool stopped : {false, true}) {
    ManualClock clock;
    ServoLoop loop(clock);
    Motors device;
    struct Push final : ServoTask {
      Motors& device;
      ServoLoop* loop;
      Push(Motors& d, ServoLoop* l) : device(d), loop(l) {}
      bool tick(std::uint64_t) noexcept override {
        device.write({.force_n = {0, 0, 3}});
        if (loop != nullptr) loop->stop();
        return loop != nullptr;
      }
    } task(device, stopped ? &loop : nullptr);
    bool prepared = false;
    run_watched(loop, task, {.zero = [&] { device.write({}); }, .stop = [&] { device.stop(); }},
                [&] { prepared = true; });
    EXPECT_TRUE(prepared);
    EXPECT_EQ(device.output, Wrench{}) << stopped;
    EXPECT_GE(device.stops, 1);
  }
}

TEST(Watchdog, RunsOnItsOwnThread) {
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

TEST(Watchdog, StopsTheDeviceInEachOfSeveralStalls) {
  MonotonicClock clock;
  ServoLoop loop(clock);
  std::atomic<int> stops{0};
  Watchdog watchdog(loop, [&] { ++stops; });
  // Runs for longer than an alarm that is not postponed, and stalls until the device was stopped.
  struct Stumble final : ServoTask {
    std::atomic<int>& stops;
    int ticks = 0, stalls = 0;
    explicit Stumble(std::atomic<int>& s) : stops(s) {}
    bool tick(std::uint64_t) noexcept override {
      constexpr int kTicksOfARun = 30;
      if (++ticks % kTicksOfARun != 0) return true;
      const int before = stops;
      const auto give_up = std::chrono::steady_clock::now() + std::chrono::seconds(20);
      while (stops == before && std::chrono::steady_clock::now() < give_up) {
        std::this_thread::yield();
      }
      if (stops == before) return false;
      return ++stalls < 3;
    }
  } task(stops);
  watchdog.start();
  std::thread servo([&] { loop.run(task); });
  servo.join();
  watchdog.end();
  EXPECT_EQ(task.stalls, 3);
  EXPECT_GE(watchdog.stops(), 3U);
}

TEST(ServoLoop, PostponesTheAlarmUntilTheHeartbeatIsStale) {
  Alarm alarm;
  MonotonicClock clock;
  ServoLoop loop(clock);
  loop.set_off_without_heartbeat(alarm);
  struct Run final : ServoTask {
    int left = 40;
    bool tick(std::uint64_t) noexcept override { return --left > 0; }
  } task;
  loop.run(task);
  alarm.wait();
  EXPECT_GE(monotonic_ns() - loop.heartbeat_ns(), ServoLoop::kStaleNs);
}

}  // namespace
}  // namespace kerf::agent::safety_test
