// SPDX-License-Identifier: Apache-2.0
// Tests libkerf_agent.so through its C interface only, against a small server.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <thread>

#include "haptic_agent/library/kerf_agent.h"
#include "tests/agent/link/fake_server.h"

namespace kerf::agent {
namespace {

using std::chrono::milliseconds;

/// The surface of the server below, and how deep the test presses into it.
constexpr double kNPerMm = 0.5, kPressedMm = 3, kServedN = kNPerMm * kPressedMm;

template <typename T>
T sized() {
  T value{};
  value.struct_size = sizeof value;
  return value;
}

kerf_agent_pose pose_at(double z_mm, std::uint32_t buttons = 0) {
  auto pose = sized<kerf_agent_pose>();
  pose.state = KERF_AGENT_READY;
  pose.tip_mm[2] = z_mm;
  pose.axis[2] = 1;
  pose.buttons = buttons;
  return pose;
}

double norm(const double (&v)[3]) { return std::hypot(v[0], v[1], v[2]); }

/// A server with an elastic surface at z = 0.
class LibraryTest : public ::testing::Test {
 protected:
  void SetUp() override {
    device_.name = "test device";
    device_.actuated_dof = 3;
    device_.max_force_n = 10;
    device_.moving_mass_kg = 1;
    device_.moving_inertia_kg_m2 = 1e-3;
  }
  void TearDown() override {
    kerf_agent_close(agent_, 0);
    server_.reset();
  }

  void serve(FakeServer::Behaviour behaviour = {}) {
    server_.emplace([this](FakePeer& peer, int) { push_up(peer); }, behaviour);
  }

  void push_up(FakePeer& peer) {
    peer.read_text();
    peer.send_text(welcome_text());
    while (const auto batch = peer.read_motion()) {
      const wire::MotionSample& last = batch->view().back();
      tool_ = last.tool_id;
      const double depth_mm = -last.tip_mm.z;
      wire::Result result{.agent_sequence = last.agent_sequence,
                          .agent_time_us = last.time_us,
                          .force_n = {0, 0, static_cast<float>(kNPerMm * std::max(0.0, depth_mm))},
                          .plane_count = 1};
      result.planes[0] = {.point_mm = last.tip_mm,
                          .normal = {0, 0, 1},
                          .depth_mm = static_cast<float>(depth_mm),
                          .stiffness_n_per_mm = static_cast<float>(kNPerMm),
                          .radius_mm = 5,
                          .flags = wire::kContactStock};
      peer.send_result(result, 1);
    }
  }

  kerf_agent_options options() {
    auto options = sized<kerf_agent_options>();
    url_ = "http://127.0.0.1:" + std::to_string(server_ ? server_->port() : 1);
    options.flags = KERF_AGENT_NO_COPY | KERF_AGENT_NO_REALTIME;
    options.server = url_.c_str();
    options.session = "demo";
    options.patience_s = 5;
    options.device = &device_;
    return options;
  }
  void connect() {
    const kerf_agent_options given = options();
    ASSERT_EQ(kerf_agent_connect(&given, &agent_), KERF_AGENT_OK) << kerf_agent_last_error();
  }
  kerf_agent_result connect_fails(const kerf_agent_options& given) {
    agent_ = reinterpret_cast<kerf_agent*>(this);  // to be set to null
    const kerf_agent_result result = kerf_agent_connect(&given, &agent_);
    EXPECT_EQ(agent_, nullptr);
    EXPECT_STRNE(kerf_agent_last_error(), "");
    return result;
  }

  kerf_agent_status status() {
    auto status = sized<kerf_agent_status>();
    EXPECT_EQ(kerf_agent_get_status(agent_, &status), KERF_AGENT_OK);
    return status;
  }
  kerf_agent_result step(const kerf_agent_pose& pose) {
    return kerf_agent_step(agent_, &pose, &wrench_);
  }
  /// Runs a loop of 1 kHz until the condition holds. A busy machine trips the envelope, which the
  /// user then re-arms; the limit of 20 s only ends a failed test.
  template <typename Condition>
  bool tick_until(const kerf_agent_pose& pose, Condition condition, bool rearm = true) {
    auto due = std::chrono::steady_clock::now();
    for (int i = 0; i < 20'000; ++i) {
      std::this_thread::sleep_until(due += milliseconds(1));
      EXPECT_EQ(step(pose), KERF_AGENT_OK);
      if (condition()) return true;
      if (rearm && i % 500 == 499 && status().tripped) kerf_agent_rearm(agent_);
    }
    return false;
  }
  /// Holds the device above the surface until the force is on, then presses until it is felt.
  bool feel(std::uint32_t buttons = 0) {
    kerf_agent_pose pose = pose_at(1, buttons);
    const auto felt = [&] {
      const double aim_mm = status().phase == KERF_AGENT_PHASE_ACTIVE ? -kPressedMm : 1;
      constexpr double kStepMm = 0.05;
      pose.tip_mm[2] += std::clamp(aim_mm - pose.tip_mm[2], -kStepMm, kStepMm);
      return pose.tip_mm[2] <= -kPressedMm && std::abs(wrench_.force_n[2] - kServedN) < 0.1;
    };
    return tick_until(pose, felt);
  }

  std::optional<FakeServer> server_;
  std::string url_;
  kerf_agent_capabilities device_ = sized<kerf_agent_capabilities>();
  kerf_agent* agent_ = nullptr;
  kerf_agent_wrench wrench_ = sized<kerf_agent_wrench>();
  std::atomic<std::uint32_t> tool_{0};
};

TEST(LibraryInterface, StatesItsVersionAndTexts) {
  EXPECT_EQ(kerf_agent_version(), KERF_AGENT_VERSION);
  for (int result = KERF_AGENT_OK; result >= KERF_AGENT_INTERNAL; --result) {
    EXPECT_STRNE(kerf_agent_result_text(result), kerf_agent_result_text(1)) << result;
  }
  EXPECT_STREQ(kerf_agent_result_text(1), "unknown result");
}

TEST_F(LibraryTest, InvalidOptionsNameTheirField) {
  const auto fault = [this](auto change) {
    kerf_agent_options given = options();
    change(given);
    EXPECT_EQ(connect_fails(given), KERF_AGENT_INVALID);
    return std::string(kerf_agent_last_error());
  };
  const auto names = [](const std::string& text, const char* field) {
    return text.find(field) != text.npos;
  };
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(names(fault([](auto& o) { o.session = nullptr; }), "session"));
  EXPECT_TRUE(names(fault([](auto& o) { o.session = "a/b"; }), "session"));
  EXPECT_TRUE(names(fault([](auto& o) { o.server = "https://x"; }), "TLS"));
  EXPECT_TRUE(names(fault([](auto& o) { o.color = "red"; }), "color"));
  EXPECT_TRUE(names(fault([](auto& o) { o.max_force_n = kNan; }), "max_force_n"));
  EXPECT_TRUE(names(fault([](auto& o) { o.patience_s = -1; }), "patience_s"));
  EXPECT_TRUE(names(fault([](auto& o) { o.flags = 1U << 20; }), "flags"));
  EXPECT_TRUE(names(fault([this](auto&) { device_.max_force_n = 1e6; }), "max_force_n"));
  device_.max_force_n = 10;
  EXPECT_TRUE(names(fault([this](auto&) { device_.latency_us = 50'000; }), "latency_us"));
  device_.latency_us = 0;
  EXPECT_TRUE(names(fault([this](auto&) { device_.sensed_dof = 6; }), "sensed_dof"));
  EXPECT_EQ(kerf_agent_connect(nullptr, &agent_), KERF_AGENT_INVALID);
  EXPECT_EQ(kerf_agent_connect(nullptr, nullptr), KERF_AGENT_INVALID);
}

TEST_F(LibraryTest, StructuresOfOtherVersionsAreAcceptedOrRejectedByTheirContents) {
  serve();
  struct Longer {
    kerf_agent_options known;
    std::uint64_t added;
  } longer{};
  longer.known = options();
  longer.known.struct_size = sizeof longer;
  longer.added = 1;
  EXPECT_EQ(connect_fails(longer.known), KERF_AGENT_UNSUPPORTED);
  longer.added = 0;
  ASSERT_EQ(kerf_agent_connect(&longer.known, &agent_), KERF_AGENT_OK) << kerf_agent_last_error();
  kerf_agent_options none = options();
  none.struct_size = 0;
  kerf_agent* other = nullptr;
  EXPECT_EQ(kerf_agent_connect(&none, &other), KERF_AGENT_UNSUPPORTED);

  // A shorter structure is filled in as far as it goes, and not beyond.
  auto session = sized<kerf_agent_session>();
  session.struct_size = offsetof(kerf_agent_session, tool_ids);
  session.tool_count = 77;
  ASSERT_EQ(kerf_agent_get_session(agent_, &session), KERF_AGENT_OK);
  EXPECT_EQ(session.participant, 3U);
  EXPECT_EQ(session.struct_size, offsetof(kerf_agent_session, tool_ids));
  EXPECT_EQ(session.tool_count, 77U);
  session.struct_size = 0;
  EXPECT_EQ(kerf_agent_get_session(agent_, &session), KERF_AGENT_INVALID);
}

TEST_F(LibraryTest, ServerThatIsAbsentOrRejectsHasAResultOfItsOwn) {
  kerf_agent_options absent = options();
  absent.patience_s = 0.05;
  EXPECT_EQ(connect_fails(absent), KERF_AGENT_UNREACHABLE);
  serve({.decline_status = 404});
  EXPECT_EQ(connect_fails(options()), KERF_AGENT_REJECTED);
}

TEST_F(LibraryTest, ToolsOfTheSessionCanBeChosen) {
  serve();
  kerf_agent_options given = options();
  given.tool_id = 9;
  EXPECT_EQ(connect_fails(given), KERF_AGENT_NO_TOOL);
  connect();
  auto session = sized<kerf_agent_session>();
  ASSERT_EQ(kerf_agent_get_session(agent_, &session), KERF_AGENT_OK);
  ASSERT_EQ(session.tool_count, 2U);
  EXPECT_EQ(session.tool_id, session.tool_ids[0]);
  EXPECT_STREQ(session.name, "demo");
  EXPECT_EQ(session.pivot_mm, 60);
  EXPECT_EQ(session.stock_min_mm[0], -50);
  EXPECT_EQ(kerf_agent_choose_tool(agent_, 9), KERF_AGENT_NO_TOOL);
  EXPECT_EQ(kerf_agent_choose_tool(agent_, 2), KERF_AGENT_OK);
  EXPECT_TRUE(tick_until(pose_at(5), [this] { return tool_ == 2; }));
}

TEST_F(LibraryTest, HeldDeviceFeelsTheServersForceAfterTheRamp) {
  serve();
  connect();
  ASSERT_TRUE(feel());
  EXPECT_LE(norm(wrench_.force_n), 0.6 * device_.max_force_n);
  const kerf_agent_status now = status();
  EXPECT_EQ(now.connected, 1U);
  EXPECT_GT(now.ticks, 0U);
  EXPECT_GT(now.felt_factor, 0.8);
  EXPECT_NEAR(now.computed_force_n[2], kServedN, 0.1);
  EXPECT_NEAR(now.felt_force_n[2], wrench_.force_n[2], 1e-9);
  EXPECT_FALSE(now.tripped);
}

TEST_F(LibraryTest, DeviceWithADeadmanSensorFeelsNothingUntilHeld) {
  serve();
  device_.flags = KERF_AGENT_HAS_DEADMAN;
  connect();
  int ticks = 0;
  double most = 0;
  ASSERT_TRUE(tick_until(pose_at(-kPressedMm), [&] {
    most = std::max(most, norm(wrench_.force_n));
    return ++ticks > 900;
  }));
  EXPECT_EQ(most, 0);
  EXPECT_TRUE(feel(KERF_AGENT_DEADMAN));
}

TEST_F(LibraryTest, TripsOnAnInvalidPoseUntilRearmed) {
  serve();
  connect();
  ASSERT_TRUE(feel());
  const kerf_agent_pose bad = pose_at(std::numeric_limits<double>::infinity());
  std::this_thread::sleep_for(milliseconds(1));
  EXPECT_EQ(step(bad), KERF_AGENT_INVALID);
  EXPECT_EQ(norm(wrench_.force_n), 0);
  const kerf_agent_status tripped = status();
  EXPECT_EQ(tripped.tripped, 1U);
  EXPECT_EQ(tripped.phase, std::uint32_t{KERF_AGENT_PHASE_SAFE});
  EXPECT_STREQ(tripped.phase_text, "safe");
  EXPECT_STREQ(tripped.trip_text, "pose_not_finite");

  // It stays without force as long as nobody re-arms it.
  int ticks = 0;
  ASSERT_TRUE(tick_until(pose_at(0), [&] { return ++ticks > 700; }, false));
  EXPECT_EQ(status().tripped, 1U);
  EXPECT_EQ(norm(wrench_.force_n), 0);
  EXPECT_EQ(kerf_agent_rearm(agent_), KERF_AGENT_OK);
  EXPECT_TRUE(feel());
}

TEST_F(LibraryTest, CallsWithinHalfAMillisecondAreOneTick) {
  serve();
  connect();
  const kerf_agent_pose pose = pose_at(5);
  const auto begin = std::chrono::steady_clock::now();
  for (int i = 0; i < 1000; ++i) ASSERT_EQ(step(pose), KERF_AGENT_OK);
  const auto passed = std::chrono::steady_clock::now() - begin;
  const auto half_ms = std::chrono::duration_cast<std::chrono::microseconds>(passed).count() / 500;
  EXPECT_LE(status().ticks, static_cast<std::uint64_t>(half_ms) + 1);
}

TEST_F(LibraryTest, NullArgumentsAreRejectedWithoutAWrench) {
  serve();
  connect();
  const kerf_agent_pose pose = pose_at(0);
  EXPECT_EQ(kerf_agent_step(nullptr, &pose, &wrench_), KERF_AGENT_INVALID);
  EXPECT_EQ(kerf_agent_step(agent_, nullptr, &wrench_), KERF_AGENT_INVALID);
  EXPECT_EQ(kerf_agent_step(agent_, &pose, nullptr), KERF_AGENT_INVALID);
  EXPECT_EQ(kerf_agent_run(agent_, nullptr, nullptr), KERF_AGENT_INVALID);
  EXPECT_EQ(kerf_agent_get_status(agent_, nullptr), KERF_AGENT_INVALID);
  EXPECT_EQ(kerf_agent_rearm(nullptr), KERF_AGENT_INVALID);
  EXPECT_EQ(kerf_agent_stop(nullptr), KERF_AGENT_INVALID);
  kerf_agent_close(nullptr, 0);
}

/// A device for kerf_agent_run: counts its calls.
struct Counter {
  kerf_agent* agent = nullptr;
  int poses = 0, last = 0, wrenches = 0;
  std::atomic<int> stops{0};
  kerf_agent_result inner = KERF_AGENT_OK;
  double newest_n = -1;

  static void read_pose(void* self, std::uint64_t, kerf_agent_pose* pose) {
    auto& device = *static_cast<Counter*>(self);
    EXPECT_EQ(pose->state, std::uint32_t{KERF_AGENT_ABSENT});
    *pose = pose_at(0);
    if (++device.poses == 50) {
      auto wrench = sized<kerf_agent_wrench>();
      device.inner = kerf_agent_step(device.agent, pose, &wrench);
    }
    if (device.poses == device.last) pose->state = KERF_AGENT_FINISHED;
  }
  static void write_wrench(void* self, const kerf_agent_wrench* wrench) {
    auto& device = *static_cast<Counter*>(self);
    ++device.wrenches;
    device.newest_n = norm(wrench->force_n);
  }
  static void stop(void* self) { ++static_cast<Counter*>(self)->stops; }

  kerf_agent_device table() {
    auto table = sized<kerf_agent_device>();
    table.abi = KERF_AGENT_ABI;
    table.read_pose = read_pose;
    table.write_wrench = write_wrench;
    table.stop = stop;
    return table;
  }
};

TEST_F(LibraryTest, RunsTheLoopUntilTheDeviceHasFinished) {
  serve();
  connect();
  Counter counter{.agent = agent_, .last = 100};
  kerf_agent_device table = counter.table();
  EXPECT_EQ(kerf_agent_run(agent_, &table, &counter), KERF_AGENT_OK);
  EXPECT_EQ(counter.poses, 100);
  EXPECT_EQ(counter.wrenches, 100);
  EXPECT_EQ(counter.inner, KERF_AGENT_BUSY) << "two loops at a time";
  EXPECT_EQ(counter.newest_n, 0) << "the last wrench switches the motors off";
  EXPECT_GE(counter.stops, 1);
  // A loop of the caller follows, and another one of the library.
  EXPECT_EQ(step(pose_at(0)), KERF_AGENT_OK);
  table.abi = KERF_AGENT_ABI + 1;
  EXPECT_EQ(kerf_agent_run(agent_, &table, &counter), KERF_AGENT_UNSUPPORTED);
  table = counter.table();
  table.read_pose = nullptr;
  EXPECT_EQ(kerf_agent_run(agent_, &table, &counter), KERF_AGENT_INVALID);
}

TEST_F(LibraryTest, StopEndsTheLoopAndALostServerToo) {
  serve();
  connect();
  Counter counter{.agent = agent_};
  const kerf_agent_device table = counter.table();
  std::thread user([this] {
    std::this_thread::sleep_for(milliseconds(30));
    kerf_agent_stop(agent_);
  });
  EXPECT_EQ(kerf_agent_run(agent_, &table, &counter), KERF_AGENT_OK);
  user.join();
  kerf_agent_close(agent_, 0);

  kerf_agent_options given = options();
  given.patience_s = 0.05;
  ASSERT_EQ(kerf_agent_connect(&given, &agent_), KERF_AGENT_OK);
  Counter other{.agent = agent_};
  std::thread crash([this] {
    std::this_thread::sleep_for(milliseconds(30));
    server_.reset();
  });
  EXPECT_EQ(kerf_agent_run(agent_, &table, &other), KERF_AGENT_LOST);
  crash.join();
  EXPECT_EQ(step(pose_at(0)), KERF_AGENT_LOST);
  EXPECT_EQ(status().connected, 0U);
}

}  // namespace
}  // namespace kerf::agent
