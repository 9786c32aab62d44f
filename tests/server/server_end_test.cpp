// SPDX-License-Identifier: Apache-2.0
#include "server/server.h"
#include "tests/bench/raster_agent.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test.h"

namespace kerf::net::server_end_test {
namespace {

constexpr const char* kScene = R"({"name": "bench",
  "stock": {"shape": "box", "min_mm": [-40, -40, -30], "max_mm": [40, 40, 0]},
  "accuracy": {"rays": "dexel", "pitch_mm": 0.5, "tolerance_mm": 0.01, "motion": "tight"},
  "tools": [{"id": 1, "shape": "ball", "diameter_mm": 10, "length_mm": 60}]})";

std::unique_ptr<Server> start(const std::filesystem::path& folder, SessionLimits limits = {}) {
  ServerOptions options{
      .port = 0, .http = {.data_folder = folder}, .session = limits, .udp = {.on = false}};
  auto made = Server::create(options);
  EXPECT_TRUE(made) << made.error();
  const auto listening = (*made)->listen();
  EXPECT_TRUE(listening) << listening.error();
  return *std::move(made);
}

/// A crowd: the session is read for it during a job and after it.
std::vector<bench::WebSocket> watch(std::uint16_t port, int count) {
  std::vector<bench::WebSocket> viewers;
  std::string payload;
  for (int n = 0; n < count; ++n) {
    viewers.push_back(bench::join(port, "view", wire::kViewProtocol));
    while (viewers.back().receive(payload, bench::in_seconds(30)) != 1) continue;
    EXPECT_NE(payload.find("\"welcome\""), payload.npos) << payload;
  }
  return viewers;
}

/// Cuts until the server accepts no more.
void cut_until_the_end(bench::WebSocket& agent) {
  std::vector<std::byte> frame;
  for (std::uint64_t n = 1;; ++n) {
    wire::MotionBatch batch{.count = 1};
    batch.samples[0] = bench::sample_at(n, 0);
    frame.clear();
    wire::append(frame, {bench::kNewEpoch, n, n * 1000}, batch);
    if (!agent.try_send(2, frame)) return;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

// Two are admitted at once, and one each quarter of a second.
TEST(Audience, LargeAudienceIsAdmittedInTurn) {
  const test::TemporaryFolder folder;
  const auto server = start(
      folder.path(), {.viewer_joins_per_s = 4, .viewer_joins_burst = 2, .viewer_wait_max_s = 1.5});
  bench::post(server->port(), "/v1/sessions?id=bench", kScene);
  std::vector<bench::WebSocket> viewers;
  for (int n = 0; n < 30; ++n) {
    viewers.push_back(bench::join(server->port(), "view", wire::kViewProtocol));
  }
  int welcomed = 0, rejected = 0;
  std::string payload;
  for (auto& viewer : viewers) {
    while (viewer.receive(payload, bench::in_seconds(30)) != 1) continue;
    welcomed += payload.contains("\"welcome\"") ? 1 : 0;
    rejected += payload.contains("too many participants join") ? 1 : 0;
  }
  EXPECT_GE(welcomed, 2 + 6) << "those that wait for 1.5 s at most are let in";
  EXPECT_EQ(welcomed + rejected, 30);
}

// Peers that neither read nor close are still connected when the threads end one after the other.
TEST(ServerEnd, WithViewersLeavesNothingBehind) {
  const test::TemporaryFolder folder;
  for (int turn = 0; turn < 3; ++turn) {
    auto server = start(folder.path());
    if (turn == 0) bench::post(server->port(), "/v1/sessions?id=bench", kScene);
    const auto viewers = watch(server->port(), 60);
    std::future<void> cut;
    if (turn == 0) {
      cut = std::async(std::launch::async, [agent = bench::join_agent(server->port())]() mutable {
        cut_until_the_end(agent);
      });
      while (bench::json_field(bench::get(server->port(), "/v1/sessions/bench"), "motions") == "0")
        std::this_thread::yield();
    }
    server.reset();  // also releases the folder for the next server
  }
}

TEST(ServerStart, InAUsedFolderFailsAndChangesNothing) {
  const test::TemporaryFolder folder;
  const auto first = start(folder.path());
  bench::post(first->port(), "/v1/sessions?id=bench", kScene);
  ServerOptions options{.http = {.data_folder = folder.path()}};
  const auto error = test::error_of(Server::create(options));
  EXPECT_TRUE(error.contains("in use")) << error;
  EXPECT_EQ(bench::json_field(bench::get(first->port(), "/v1/sessions/bench"), "paused"), "null");
}

}  // namespace
}  // namespace kerf::net::server_end_test
