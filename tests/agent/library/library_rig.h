// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "haptic_agent/library/kerf_agent.h"
#include "tests/agent/library/stepped_clock.h"
#include "tests/agent/link/fake_server.h"
#include "tests/support/test.h"

namespace kerf::agent {

using std::chrono::milliseconds;

/// Stiffness of the server's surface below, and the depth to which the test presses.
inline constexpr double kNPerMm = 0.5, kPressedMm = 3, kServedN = kNPerMm * kPressedMm;

template <typename T>
T sized() {
  T value{};
  value.struct_size = sizeof value;
  return value;
}

inline kerf_agent_pose pose_at(double z_mm, std::uint32_t buttons = 0) {
  auto pose = sized<kerf_agent_pose>();
  pose.state = KERF_AGENT_READY;
  pose.tip_mm[2] = z_mm;
  pose.axis[2] = 1;
  pose.buttons = buttons;
  return pose;
}

inline double norm(const double (&v)[3]) { return std::hypot(v[0], v[1], v[2]); }

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
    SteppedClock::release();
  }

  void serve(FakeServer::Behaviour behaviour = {}) {
    server_.emplace([this](FakePeer& peer, int) { push_up(peer); }, behaviour);
  }

  void push_up(FakePeer& peer) {
    peer.read_text();
    peer.send_text(welcome_);
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
      note_answer(last.time_us);
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
    agent_ = reinterpret_cast<kerf_agent*>(this);  // must be set to null
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
  /// A step 1 ms after the previous one, on the library's stepped clock. Then waits for the
  /// server's answer, so that answers are as old as on an idle machine. The wait is short, because
  /// a lost server gives none.
  kerf_agent_result tick(const kerf_agent_pose& pose) {
    constexpr std::uint64_t kTickUs = 1000, kBehindUs = 4 * kTickUs;
    SteppedClock::advance_us(kTickUs);
    const kerf_agent_result result = step(pose);
    std::unique_lock lock(answer_mutex_);
    const std::uint64_t due_us = SteppedClock::now_us() - kBehindUs;
    has_answered_.wait_for(lock, milliseconds(50), [&] { return answered_us_ >= due_us; });
    return result;
  }
  /// Runs a loop of 1 kHz until the condition holds. The limit of 5 s of the stepped clock ends a
  /// failed test.
  template <typename Condition>
  bool tick_until(const kerf_agent_pose& pose, Condition condition) {
    for (int i = 0; i < 5'000; ++i) {
      EXPECT_EQ(tick(pose), KERF_AGENT_OK);
      if (condition()) return true;
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

  void note_answer(std::uint64_t time_us) {
    {
      const std::scoped_lock lock(answer_mutex_);
      answered_us_ = time_us;
    }
    has_answered_.notify_all();
  }

  std::mutex answer_mutex_;
  std::condition_variable has_answered_;
  std::uint64_t answered_us_ = 0;  ///< time of the newest sample that the server answered
  std::string welcome_ = welcome_text();
  std::optional<FakeServer> server_;
  std::string url_;
  kerf_agent_capabilities device_ = sized<kerf_agent_capabilities>();
  kerf_agent* agent_ = nullptr;
  kerf_agent_wrench wrench_ = sized<kerf_agent_wrench>();
  std::atomic<std::uint32_t> tool_{0};
};

}  // namespace kerf::agent
