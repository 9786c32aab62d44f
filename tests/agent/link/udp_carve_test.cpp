// SPDX-License-Identifier: Apache-2.0
// The real link against the real server, in one process: carving over a faulty line gives the same
// block as over a good one, bit for bit.
#include "haptic_agent/link/server_link.h"
#include "server/server.h"
#include "server/threads/run_and_wait.h"
#include "tests/agent/link/lossy_line.h"
#include "tests/support/eventually.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test.h"

namespace kerf::agent::udp_carve_test {
namespace {

using test::eventually;

using std::chrono::milliseconds;

constexpr const char* kScene = R"({
  "name": "block",
  "stock": {"shape": "box", "min_mm": [-30, -30, -20], "max_mm": [30, 30, 0]},
  "accuracy": {"rays": "dexel", "pitch_mm": 0.5, "tolerance_mm": 0.01, "motion": "tight"},
  "tools": [{"id": 1, "shape": "ball", "diameter_mm": 4, "length_mm": 60},
            {"id": 2, "shape": "flat", "diameter_mm": 3, "length_mm": 60}],
  "machine": {"kinematics": "tool-vector"}})";

/// An outward spiral with alternating depth: no sample may be merged, and a chord over a gap would
/// change the block.
wire::MotionSample path(std::uint64_t n, std::uint64_t tool_change_at) {
  const double turn = 0.02 * static_cast<double>(n);
  const double radius = 3 + 0.35 * turn;
  const double depth = n % 2 == 0 ? -1.0 : -1.2;
  return {.time_us = 1000 * n,
          .tip_mm = {radius * std::cos(turn), radius * std::sin(turn), depth},
          .tool_id = n >= tool_change_at ? 2U : 1U,
          .buttons = wire::kButtonCutting};
}

class UdpCarve : public testing::Test {
 protected:
  static constexpr std::uint64_t kSamples = 3000;
  static constexpr std::uint64_t kNever = ~std::uint64_t{0};

  struct Carved {
    std::uint64_t hash = 0, motions = 0;
    LinkReport report;
    std::vector<std::string> notices;
  };

  void SetUp() override { start(true); }
  void start(bool with_udp) {
    server.reset();
    net::ServerOptions options{
        .port = 0, .http = {.data_folder = folder_.path()}, .udp = {.on = with_udp, .port = 0}};
    auto made = test::value_of(net::Server::create(options));
    server = std::move(made);
    const auto listening = server->listen();
    ASSERT_TRUE(listening) << listening.error();
    ASSERT_EQ(server->udp_port() != 0, with_udp);
  }

  void line(const LineFaults& faults) { line_.emplace(server->port(), server->udp_port(), faults); }

  /// Carves the path in a new session. `at` is called before each sample.
  Carved carve(const std::string& session, bool udp,
               const std::function<void(std::uint64_t)>& at = {},
               std::uint64_t tool_change_at = kNever) {
    const auto block = server->sessions().create(session, kScene, SceneSource{});
    EXPECT_TRUE(block);
    Carved carved;
    std::mutex mutex;
    SampleRing ring;
    LatestValue<ServerWrench> wrenches;
    ServerLink link(
        {.server = {line_ ? LossyLine::kHost : "127.0.0.1", std::to_string(server->port())},
         .session = session,
         .hello = {.name = "Ada", .color = "", .tool_id = 1, .udp = udp},
         .notice =
             [&](const std::string& text) {
               const std::scoped_lock lock(mutex);
               carved.notices.push_back(text);
             },
         .failed = {}},
        ring, wrenches);
    link.start();
    const auto welcome = link.wait_welcome();
    EXPECT_TRUE(welcome);
    for (std::uint64_t n = 1; n <= kSamples; ++n) {
      if (at) at(n);
      while (!ring.push(path(n, tool_change_at))) std::this_thread::sleep_for(milliseconds(1));
      link.sample_ready();
      if (n % 4 == 0) std::this_thread::sleep_for(milliseconds(4));
    }
    link.stop(20);
    carved.report = link.report();
    EXPECT_EQ(carved.report.failure, "");
    EXPECT_EQ(carved.report.unanswered, 0U);
    EXPECT_EQ(carved.report.merged_cuts + carved.report.thinned_cuts, 0U);
    run_and_wait((*block)->executor(), [&] {
      carved.hash = (*block)->solid().hash();
      carved.motions = (*block)->info().motions;
      return 0;
    });
    return carved;
  }

  /// Result over a good WebSocket, computed once for all tests.
  const Carved& over_web_socket() {
    static const Carved kCarved = carve("plain", false);
    return kCarved;
  }

  static void expect_equal(const Carved& a, const Carved& b) {
    EXPECT_EQ(a.motions, b.motions);
    EXPECT_EQ(a.hash, b.hash);
    EXPECT_EQ(a.report.samples_sent - a.report.resent, b.report.samples_sent - b.report.resent);
  }

  test::TemporaryFolder folder_;
  std::unique_ptr<net::Server> server;
  std::optional<LossyLine> line_;
};

TEST_F(UdpCarve, CleanLineUsesUdp) {
  const Carved& plain = over_web_socket();
  EXPECT_EQ(plain.motions, kSamples - 1);
  EXPECT_EQ(plain.report.udp.sent, 0U);
  EXPECT_FALSE(plain.report.udp.offered);
  const Carved udp = carve("udp", true);
  expect_equal(udp, plain);
  EXPECT_TRUE(udp.report.udp.carries);
  EXPECT_EQ(udp.report.udp.taken_over, 1U);
  EXPECT_GT(udp.report.udp.samples, 0U);
  EXPECT_TRUE(udp.notices.empty()) << udp.notices.front();
}

TEST_F(UdpCarve, WithoutServerUdpTheWebSocketCarriesAll) {
  const Carved& plain = over_web_socket();
  start(false);
  const Carved without = carve("without", true);
  expect_equal(without, plain);
  EXPECT_TRUE(without.report.udp.asked);
  EXPECT_FALSE(without.report.udp.offered);
  EXPECT_EQ(without.notices,
            std::vector<std::string>{"the server has no UDP transport, staying on the WebSocket"});
}

TEST_F(UdpCarve, LossDuplicationAndReorderingChangeNothing) {
  const Carved& plain = over_web_socket();
  line({.delay = std::chrono::microseconds(2000),
        .loss = 0.05,
        .duplication = 0.05,
        .reordering = 0.05,
        .seed = 3});
  const Carved udp = carve("udp", true);
  expect_equal(udp, plain);
  EXPECT_GT(udp.report.udp.samples, 0U);
  EXPECT_GT(udp.report.udp.repeated, 0U);
  EXPECT_GT(udp.report.udp.dropped, 0U) << "duplicates are dropped";
  EXPECT_GT(udp.report.udp.lost, 0U);
  const LineCounts counts = line_->counts();
  EXPECT_GT(counts.lost, 0U);
  EXPECT_GT(counts.duplicated, 0U);
  EXPECT_GT(counts.reordered, 0U);
}

TEST_F(UdpCarve, LossLongerThanTheRepetitionsCausesAResend) {
  const Carved& plain = over_web_socket();
  // Longer than the sixteen samples of a datagram, in both directions.
  line({.delay = std::chrono::microseconds(2000), .burst_every = 400, .burst = 80});
  const Carved udp = carve("udp", true);
  expect_equal(udp, plain);
  EXPECT_GT(udp.report.udp.samples, 0U);
  EXPECT_GT(udp.report.resent, 0U);
}

TEST_F(UdpCarve, BlockedPortFallsBackToTheWebSocket) {
  const Carved& plain = over_web_socket();
  line({});
  line_->block_udp(true);
  const Carved udp = carve("udp", true);
  expect_equal(udp, plain);
  EXPECT_EQ(udp.report.udp.samples, 0U);
  EXPECT_EQ(udp.report.udp.received, 0U);
  EXPECT_TRUE(udp.report.udp.offered);
  EXPECT_EQ(udp.notices, std::vector<std::string>{"no answer over UDP, staying on the WebSocket"});
}

TEST_F(UdpCarve, OutageSwitchesBackToTheWebSocket) {
  const Carved& plain = over_web_socket();
  line({});
  const Carved udp = carve("udp", true, [&](std::uint64_t n) {
    if (n == 1000) line_->block_udp(true);
  });
  expect_equal(udp, plain);
  EXPECT_GT(udp.report.udp.samples, 0U);
  EXPECT_EQ(udp.report.udp.fell_back, 1U);
  EXPECT_FALSE(udp.report.udp.carries);
  EXPECT_EQ(udp.notices, std::vector<std::string>{"UDP has gone silent, back on the WebSocket"});
}

TEST_F(UdpCarve, UdpIsUsedAgainAfterAnOutage) {
  const Carved& plain = over_web_socket();
  line({});
  const Carved udp = carve("udp", true, [&](std::uint64_t n) {
    if (n == 500) line_->block_udp(true);
    if (n == 1500) line_->block_udp(false);
  });
  expect_equal(udp, plain);
  EXPECT_GE(udp.report.udp.fell_back, 1U);
  // The pause ends before the samples do.
  EXPECT_GE(udp.report.udp.taken_over, 2U);
}

TEST_F(UdpCarve, ChangeOfAddressIsFollowed) {
  const Carved& plain = over_web_socket();
  line({});
  const Carved udp = carve("udp", true, [&](std::uint64_t n) {
    if (n % 700 == 0) line_->rebind();
  });
  expect_equal(udp, plain);
  EXPECT_GT(udp.report.udp.samples, 0U);
}

TEST_F(UdpCarve, ToolChangeStaysInOrderWithTheSamples) {
  const Carved plain = carve("plain", false, {}, 1500);
  EXPECT_EQ(plain.motions, kSamples - 2) << "the new tool starts at its first sample";
  // The tool message on the WebSocket arrives long after the samples sent at the same time.
  line({.delay = std::chrono::microseconds(2000),
        .tcp_delay = std::chrono::microseconds(30'000),
        .loss = 0.05,
        .reordering = 0.05});
  const Carved udp = carve("udp", true, {}, 1500);
  expect_equal(udp, plain);
  EXPECT_GT(udp.report.udp.samples, 0U);
}

}  // namespace
}  // namespace kerf::agent::udp_carve_test
