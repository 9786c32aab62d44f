// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/link/server_link.h"

#include <nlohmann/json.hpp>

#include "tests/agent/link/fake_server.h"
#include "tests/support/eventually.h"
#include "tests/support/test.h"

namespace kerf::agent::server_link_test {
namespace {

using std::chrono::milliseconds;
using test::eventually;

/// The samples that a server has received, per connection.
struct Received {
  mutable std::mutex mutex;
  std::vector<std::vector<wire::MotionSample>> connections;

  void add(int connection, const wire::MotionBatch& batch) {
    const std::scoped_lock lock(mutex);
    connections.resize(static_cast<std::size_t>(connection) + 1);
    auto& samples = connections[static_cast<std::size_t>(connection)];
    samples.insert(samples.end(), batch.view().begin(), batch.view().end());
  }
  std::size_t count(std::size_t connection) const {
    const std::scoped_lock lock(mutex);
    return connection < connections.size() ? connections[connection].size() : 0;
  }
};

class ServerLinkTest : public ::testing::Test {
 protected:
  LinkSettings settings(const FakeServer& server) {
    return {.server = {.host = "127.0.0.1", .port = std::to_string(server.port())},
            .session = "demo",
            .hello = {.name = "Ada", .color = "#112233", .tool_id = 2},
            .patience_s = 5.0,
            .notice =
                [this](const std::string& text) {
                  const std::scoped_lock lock(mutex);
                  notices.push_back(text);
                },
            .failed = [this] { failed = true; }};
  }

  void push(ServerLink& link, std::uint64_t from, std::uint64_t to,
            std::uint32_t buttons = wire::kButtonCutting) {
    for (std::uint64_t i = from; i <= to; ++i) {
      // A zigzag, because waiting samples of a straight cut would be merged.
      const double z = i % 2 == 0 ? 1 : 0;
      while (!samples.push({.time_us = i, .tip_mm = {0, 0, z}, .tool_id = 2, .buttons = buttons})) {
        std::this_thread::sleep_for(milliseconds(1));
      }
      link.sample_ready();
    }
  }

  static wire::Result answer_to(const wire::MotionBatch& batch, float fz = 0) {
    const wire::MotionSample& last = batch.view().back();
    return {.agent_sequence = last.agent_sequence,
            .agent_time_us = last.time_us,
            .force_n = {0, 0, fz}};
  }

  SampleRing samples;
  LatestValue<ServerWrench> wrenches;
  std::mutex mutex;
  std::vector<std::string> notices;
  std::atomic<bool> failed{false};
};

TEST_F(ServerLinkTest, SendsHelloAndParsesTheWelcome) {
  std::string hello;
  FakeServer server([&](FakePeer& peer, int) {
    hello = peer.read_text().value_or("");
    peer.send_text(R"({"type":"participants","participants":[]})");
    peer.send_text(welcome_text());
    peer.read_motion();
  });
  ServerLink link(settings(server), samples, wrenches);
  link.start();
  const auto welcome = test::value_of(link.wait_welcome());
  EXPECT_EQ(welcome.participant, 3U);
  EXPECT_EQ(welcome.pivot_mm, 60);
  EXPECT_EQ(welcome.stock.min_mm, (Vec3{-50, -50, -50}));
  EXPECT_EQ(welcome.tool_ids, (std::vector<std::uint32_t>{1, 2}));
  EXPECT_EQ(
      nlohmann::json::parse(hello),
      nlohmann::json::parse(
          R"({"type":"hello","name":"Ada","color":"#112233","tool":2,"feel":true,"durable":true})"));
  EXPECT_EQ(server.target(), "/v1/sessions/demo/agent");
  link.stop(1.0);
  EXPECT_EQ(link.report().failure, "");
}

TEST_F(ServerLinkTest, SendsEverySampleOnceInOrderAndReceivesAnswers) {
  Received received;
  std::atomic<int> pings{0};
  FakeServer server([&](FakePeer& peer, int connection) {
    peer.read_text();
    peer.send_text(welcome_text());
    while (const auto batch = peer.read_motion()) {
      received.add(connection, *batch);
      pings = peer.pings;
      peer.send_result(answer_to(*batch, 1.5F), 1);
    }
  });
  ServerLink link(settings(server), samples, wrenches);
  link.start();
  ASSERT_TRUE(link.wait_welcome());
  push(link, 1, 700);
  ASSERT_TRUE(eventually([&] { return received.count(0) == 700; }));
  push(link, 701, 701);
  link.stop(5.0);
  ASSERT_EQ(received.count(0), 701U) << "stop sends the remaining samples";
  for (std::size_t i = 0; i < 701; ++i) {
    ASSERT_EQ(received.connections[0][i].agent_sequence, i + 1);
    ASSERT_EQ(received.connections[0][i].time_us, i + 1);
  }
  EXPECT_EQ(link.report().unanswered, 0U);
  EXPECT_EQ(link.report().resent, 0U);
  EXPECT_EQ(link.report().samples_sent, 701U);
  EXPECT_GE(pings, 1);
  EXPECT_GE(link.report().clock.rtt_us().total(), 1U);
  EXPECT_NEAR(static_cast<double>(link.report().clock.offset_us()), 5e6, 1e6);
  ServerWrench wrench;
  ASSERT_TRUE(wrenches.read(wrench));
  EXPECT_EQ(wrench.wrench.force_n, (Vec3{0, 0, 1.5}));
  EXPECT_EQ(wrench.pose_us, 701U);
}

TEST_F(ServerLinkTest, ReconnectResendsUnansweredSamples) {
  Received received;
  FakeServer server([&](FakePeer& peer, int connection) {
    peer.read_text();
    peer.send_text(welcome_text());
    while (const auto batch = peer.read_motion()) {
      received.add(connection, *batch);
      // The first connection answers the first ten samples only and is closed at the 40th.
      if (connection == 0 && batch->view().back().agent_sequence > 10) {
        if (batch->view().back().agent_sequence >= 40) return peer.cut();
        continue;
      }
      peer.send_result(answer_to(*batch), 1);
    }
  });
  ServerLink link(settings(server), samples, wrenches);
  link.start();
  ASSERT_TRUE(link.wait_welcome());
  for (std::uint64_t i = 1; i <= 10; ++i) push(link, i, i);
  ASSERT_TRUE(eventually([&] { return received.count(0) == 10; }));
  push(link, 11, 60);
  ASSERT_TRUE(eventually([&] { return received.count(1) > 0; }));
  push(link, 61, 80);
  link.stop(5.0);
  const auto& again = received.connections[1];
  ASSERT_FALSE(again.empty());
  EXPECT_LE(again.front().agent_sequence, 10U)
      << "the first motion starts at the last answered sample";
  EXPECT_EQ(again.back().agent_sequence, 80U);
  for (std::size_t i = 0; i < again.size(); ++i) {
    ASSERT_EQ(again[i].agent_sequence, again.front().agent_sequence + i);
    ASSERT_EQ(again[i].time_us, again[i].agent_sequence)
        << "a number always refers to the same sample";
  }
  EXPECT_EQ(link.report().connections, 2U);
  EXPECT_GE(link.report().resent, 30U);
  EXPECT_EQ(link.report().unanswered, 0U);
  EXPECT_EQ(link.report().failure, "");
}

TEST_F(ServerLinkTest, SendsToolChanges) {
  std::atomic<bool> received{false};
  std::string text;
  FakeServer server([&](FakePeer& peer, int) {
    peer.read_text();
    peer.send_text(welcome_text());
    while (const auto batch = peer.read_motion()) {
      if (batch->view().front().tool_id == 1 && !peer.texts.empty()) {
        text = peer.texts.front();
        received = true;
      }
      peer.send_result(answer_to(*batch), 1);
    }
  });
  ServerLink link(settings(server), samples, wrenches);
  link.start();
  ASSERT_TRUE(link.wait_welcome());
  push(link, 1, 5);
  samples.push({.time_us = 6, .tool_id = 1});
  link.sample_ready();
  EXPECT_TRUE(eventually([&] { return received.load(); }));
  link.stop(1.0);
  EXPECT_EQ(text, R"({"tool":1,"type":"tool"})");
}

TEST_F(ServerLinkTest, ReportsServerErrorsAndContinues) {
  FakeServer server([&](FakePeer& peer, int) {
    peer.read_text();
    peer.send_text(welcome_text());
    peer.send_text(R"({"type":"error","code":"too_fast","reason":"sample 3","fatal":false})");
    peer.send_text(R"({"type":"error","code":"too_fast","reason":"sample 9","fatal":false})");
    peer.send_text("{nonsense");
    peer.send_bytes(std::vector<std::byte>(40));
    while (const auto batch = peer.read_motion()) peer.send_result(answer_to(*batch), 1);
  });
  ServerLink link(settings(server), samples, wrenches);
  link.start();
  ASSERT_TRUE(link.wait_welcome());
  push(link, 1, 20);
  link.stop(5.0);
  const LinkReport& report = link.report();
  ASSERT_TRUE(report.complaints.contains("too_fast"));
  EXPECT_EQ(report.complaints.at("too_fast").count, 2U);
  EXPECT_EQ(report.complaints.at("too_fast").first_reason, "sample 3");
  EXPECT_EQ(report.bad_frames, 2U);
  EXPECT_EQ(report.unanswered, 0U);
  ASSERT_EQ(notices.size(), 1U) << "one notice per error code";
  EXPECT_NE(notices[0].find("sample 3"), std::string::npos);
}

TEST_F(ServerLinkTest, FatalErrorEndsTheLink) {
  FakeServer server([&](FakePeer& peer, int) {
    peer.read_text();
    peer.send_text(welcome_text());
    peer.read_motion();
    peer.send_text(R"({"type":"error","code":"bad_frame","reason":"enough","fatal":true})");
    peer.read_motion();
  });
  ServerLink link(settings(server), samples, wrenches);
  link.start();
  ASSERT_TRUE(link.wait_welcome());
  push(link, 1, 1);
  EXPECT_TRUE(eventually([&] { return failed.load(); }));
  link.stop(1.0);
  EXPECT_EQ(link.report().failure, "bad_frame: enough");
  EXPECT_EQ(link.report().connections, 1U);
}

TEST_F(ServerLinkTest, ErrorInsteadOfWelcomeIsFinal) {
  FakeServer server([&](FakePeer& peer, int) {
    peer.read_text();
    peer.send_text(R"({"type":"error","code":"unknown_tool","reason":"no tool 2","fatal":true})");
    peer.read_text();
  });
  ServerLink link(settings(server), samples, wrenches);
  link.start();
  EXPECT_NE(test::error_of(link.wait_welcome()).find("unknown_tool: no tool 2"), std::string::npos);
  link.stop(0);
}

TEST_F(ServerLinkTest, UnknownSessionIsFinal) {
  FakeServer server([](FakePeer&, int) {}, {.decline_status = 404});
  ServerLink link(settings(server), samples, wrenches);
  link.start();
  const auto error = test::error_of(link.wait_welcome());
  EXPECT_NE(error.find("no such block (HTTP 404)"), std::string::npos) << error;
  link.stop(0);
}

TEST_F(ServerLinkTest, OtherProtocolVersionIsRejected) {
  FakeServer server([](FakePeer& peer, int) { peer.read_text(); }, {.protocol = "kerf.agent.v2"});
  ServerLink link(settings(server), samples, wrenches);
  link.start();
  const auto error = test::error_of(link.wait_welcome());
  EXPECT_NE(error.find("kerf.agent.v1"), std::string::npos) << error;
  link.stop(0);
}

TEST_F(ServerLinkTest, FailsAfterPatienceIfTheServerIsUnreachable) {
  std::uint16_t port = 0;
  {
    const FakeServer gone([](FakePeer&, int) {});
    port = gone.port();
  }
  ServerLink link({.server = {.host = "127.0.0.1", .port = std::to_string(port)},
                   .session = "demo",
                   .hello = {},
                   .patience_s = 0.2,
                   .notice = {},
                   .failed = [this] { failed = true; }},
                  samples, wrenches);
  link.start();
  const auto error = test::error_of(link.wait_welcome());
  EXPECT_NE(error.find("cannot connect to 127.0.0.1"), std::string::npos);
  link.stop(0);
  EXPECT_TRUE(failed);
}

TEST_F(ServerLinkTest, InterruptEndsTheWaitForASilentServer) {
  FakeServer server([](FakePeer& peer, int) {
    while (peer.read_text()) {
    }
  });
  ServerLink link(settings(server), samples, wrenches);
  link.start();
  link.interrupt();
  EXPECT_EQ(test::error_of(link.wait_welcome()), "interrupted");
  link.stop(0);
}

TEST_F(ServerLinkTest, RebuiltSessionIsJoinedAgain) {
  Received received;
  FakeServer server([&](FakePeer& peer, int connection) {
    peer.read_text();
    const auto epoch = static_cast<std::uint32_t>(1 + connection);
    peer.send_text(welcome_text(epoch));
    while (const auto batch = peer.read_motion()) {
      received.add(connection, *batch);
      // The session is rebuilt during the first connection.
      peer.send_result(answer_to(*batch), 2);
    }
  });
  ServerLink link(settings(server), samples, wrenches);
  link.start();
  ASSERT_TRUE(link.wait_welcome());
  push(link, 1, 30);
  EXPECT_TRUE(eventually([&] { return received.count(1) >= 30; }));
  link.stop(5.0);
  EXPECT_EQ(link.report().connections, 2U);
  EXPECT_EQ(link.report().unanswered, 0U);
}

TEST_F(ServerLinkTest, SilentServerEndsTheForce) {
  std::atomic<bool> silent{false};
  FakeServer server([&](FakePeer& peer, int) {
    peer.read_text();
    peer.send_text(welcome_text());
    while (const auto batch = peer.read_motion()) {
      if (!silent) peer.send_result(answer_to(*batch, 3.0F), 1);
    }
  });
  /// Moves down against the force: at rest, passivity would not permit any force.
  class Sinking final : public HapticDevice {
   public:
    DeviceCapabilities capabilities() const override { return {.name = "sinking"}; }
    DeviceState read(std::uint64_t now_us) noexcept override {
      z_mm_ -= 0.05;
      return {.tip_mm = {0, 0, z_mm_},
              .tool_id = 2,
              .time_us = now_us,
              .valid = true,
              .phase = DevicePhase::kReady};
    }
    void write(const Wrench& wrench) noexcept override { output_n = wrench.force_n.z; }
    void stop() noexcept override { output_n = 0; }
    std::atomic<double> output_n{0};

   private:
    double z_mm_ = 0;
  } device;
  ServerLink link(settings(server), samples, wrenches);
  link.start();
  ASSERT_TRUE(link.wait_welcome());
  ServoCycle cycle(device, samples, wrenches, link, {.mode = ForceMode::kHold});
  MonotonicClock clock;
  ServoLoop loop(clock);
  std::thread servo([&] { loop.run(cycle); });
  const bool felt = eventually([&] { return device.output_n > 2.0; });
  silent = true;
  const bool gone = eventually([&] { return device.output_n == 0.0; });
  loop.stop();
  servo.join();
  link.stop(0.1);
  EXPECT_TRUE(felt);
  EXPECT_TRUE(gone);
  EXPECT_GT(cycle.report().decayed_ticks, 0U);
}

}  // namespace
}  // namespace kerf::agent::server_link_test
