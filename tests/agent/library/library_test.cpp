// SPDX-License-Identifier: Apache-2.0
// Tests libkerf_agent.so through its C interface only, against a small server.
#include <cstddef>
#include <limits>
#include <vector>

#include "tests/agent/library/library_rig.h"

namespace kerf::agent::library_test {
namespace {

TEST(LibraryInterface, ReportsItsVersionAndTexts) {
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
  EXPECT_TRUE(names(fault([](auto& o) { o.server = "ftp://x"; }), "https://"));
  EXPECT_TRUE(names(fault([](auto& o) { o.color = "red"; }), "color"));
  EXPECT_TRUE(names(fault([](auto& o) { o.max_force_n = kNan; }), "max_force_n"));
  EXPECT_TRUE(names(fault([](auto& o) { o.patience_s = -1; }), "patience_s"));
  EXPECT_TRUE(names(fault([](auto& o) { o.flags = 1U << 20; }), "flags"));
  EXPECT_TRUE(names(fault([this](auto&) { device_.max_force_n = 1e6; }), "max_force_n"));
  device_.max_force_n = 10;
  EXPECT_TRUE(names(fault([this](auto&) { device_.latency_us = 50'000; }), "latency_us"));
  device_.latency_us = 0;
  EXPECT_TRUE(names(fault([this](auto&) { device_.max_force_n = 0; }), "max_force_n"));
  device_.max_force_n = 10;
  EXPECT_TRUE(names(fault([this](auto&) { device_.actuated_dof = 0; }), "actuated_dof"));
  device_.actuated_dof = 3;
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

  std::vector<kerf_agent_options> many(1 + 4096 / sizeof(kerf_agent_options));
  many.front() = options();
  many.front().struct_size = 4097;
  EXPECT_EQ(kerf_agent_connect(many.data(), &other), KERF_AGENT_UNSUPPORTED) << "too long";

  // A shorter structure is filled in up to its size.
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

TEST_F(LibraryTest, AbsentAndRejectingServersHaveDistinctResults) {
  kerf_agent_options absent = options();
  absent.patience_s = 0.05;
  EXPECT_EQ(connect_fails(absent), KERF_AGENT_UNREACHABLE);
  serve({.decline_status = 404});
  EXPECT_EQ(connect_fails(options()), KERF_AGENT_REJECTED);
}

TEST_F(LibraryTest, UnreadableAuthoritiesAreNamed) {
  kerf_agent_options given = options();
  given.server = "https://127.0.0.1:1";
  given.ca_file = "/no/such/authority.pem";
  EXPECT_EQ(connect_fails(given), KERF_AGENT_REJECTED);
  EXPECT_TRUE(std::string_view(kerf_agent_last_error()).contains("/no/such/authority.pem"));
  // The options of a minor 1 program end before the field.
  given.struct_size = offsetof(kerf_agent_options, ca_file);
  given.patience_s = 0.05;
  EXPECT_EQ(connect_fails(given), KERF_AGENT_UNREACHABLE);
}

TEST_F(LibraryTest, GuidesOfTheSessionAreFeltWithoutAnyOption) {
  welcome_.insert(1, R"("guides":[{"kind":"depth","lowest_z_mm":5,"stiffness_n_per_mm":0.5}],)");
  serve();
  connect();
  kerf_agent_pose pose = pose_at(6);
  const auto felt = [&] {
    const double aim_mm = status().phase == KERF_AGENT_PHASE_ACTIVE ? 2 : 6;
    constexpr double kStepMm = 0.05;
    pose.tip_mm[2] += std::clamp(aim_mm - pose.tip_mm[2], -kStepMm, kStepMm);
    return std::abs(wrench_.force_n[2] - 1.5) < 0.1;  // 3 mm below the limit, 2 mm above the stock
  };
  EXPECT_TRUE(tick_until(pose, felt)) << wrench_.force_n[2] << " N, " << status().trip_text;
}

TEST_F(LibraryTest, InvalidGuidesAreRejected) {
  welcome_.insert(1, R"("guides":[{"kind":"rail"}],)");
  serve();
  EXPECT_EQ(connect_fails(options()), KERF_AGENT_REJECTED);
  EXPECT_STREQ(kerf_agent_last_error(),
               "the session's guides are not valid: guides[0].kind \"rail\" is not a kind of "
               "guide; use path, stroke, plane, depth, region or snap");
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
  EXPECT_EQ(counter.wrenches, 101);
  EXPECT_EQ(counter.inner, KERF_AGENT_BUSY) << "two loops at a time";
  EXPECT_EQ(counter.newest_n, 0) << "the last wrench switches the motors off";
  EXPECT_GE(counter.stops, 1);
  table.stop = nullptr;
  Counter without{.agent = agent_, .last = 10};
  EXPECT_EQ(kerf_agent_run(agent_, &table, &without), KERF_AGENT_OK);
  EXPECT_GE(without.wrenches, 12) << "a wrench of zero in the place of stop";
  // A loop of the caller follows, then another one of the library.
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
}  // namespace kerf::agent::library_test
