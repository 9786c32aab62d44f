// SPDX-License-Identifier: Apache-2.0
// Control messages, and the connection on which they are sent.
#include <nlohmann/json.hpp>

#include "haptic_agent/link/server_link.h"
#include "tests/agent/link/fake_server.h"
#include "tests/support/eventually.h"
#include "tests/support/test.h"

namespace kerf::agent::link_requests_test {
namespace {

bool eventually(const std::atomic<bool>& flag) {
  return test::eventually([&] { return flag.load(); });
}

TEST(LinkRequests, RequestIsDroppedWithTheConnection) {
  std::atomic<bool> ended{false}, served{false};
  std::vector<std::string> requests;
  FakeServer server([&](FakePeer& peer, int connection) {
    peer.read_text();
    peer.send_text(welcome_text());
    const auto first = peer.read_motion();
    if (connection == 0) {
      peer.send_text(R"({"type":"stroke","undone":true,"stroke":1})");
      peer.send_text(R"({"type":"bye","reason":"moving"})");
      ended = true;
      peer.read_motion();
      return;
    }
    if (first) peer.send_result({.agent_sequence = first->view().back().agent_sequence}, 1);
    peer.read_motion();
    requests = peer.texts;
    served = true;
  });
  SampleRing samples;
  LatestValue<ServerWrench> wrenches;
  ServerLink* asks = nullptr;
  ServerLink link({.server = {.host = "127.0.0.1", .port = std::to_string(server.port())},
                   .session = "demo",
                   .hello = {.name = "Ada", .color = "#112233", .tool_id = 2},
                   .patience_s = 5.0,
                   .notice =
                       [&](const std::string& text) {
                         if (text != "stroke 1 undone") return;
                         // The link, on this thread, reads the end before it can write.
                         EXPECT_TRUE(eventually(ended));
                         asks->ask(true);
                         asks->ask(false);
                       },
                   .failed = {}},
                  samples, wrenches);
  asks = &link;
  link.start();
  ASSERT_TRUE(samples.push({.time_us = 1, .tool_id = 2}));
  link.sample_ready();
  ASSERT_TRUE(eventually(ended));
  link.stop(5.0);
  ASSERT_TRUE(eventually(served));
  EXPECT_EQ(requests, std::vector<std::string>());
}

TEST(LinkServers, LostServerIsReplacedByOneThatAppearedAfterTheWelcome) {
  std::atomic<bool> is_there{false};
  FakeServer second([&](FakePeer& peer, int) {
    peer.read_text();
    peer.send_text(welcome_text());
    is_there = true;
    peer.read_motion();
  });
  const std::string address = "http://127.0.0.1:" + std::to_string(second.port());
  FakeServer first([&](FakePeer& peer, int connection) {
    peer.read_text();
    if (connection > 0) return;  // it admits nobody any more
    peer.send_text(welcome_text());
    peer.send_text(nlohmann::json{{"type", "servers"}, {"others", {address}}}.dump());
  });
  SampleRing samples;
  LatestValue<ServerWrench> wrenches;
  ServerLink link({.server = {.host = "127.0.0.1", .port = std::to_string(first.port())},
                   .session = "demo",
                   .hello = {.name = "Ada", .color = "#112233", .tool_id = 2},
                   .patience_s = 5.0,
                   .failed = {}},
                  samples, wrenches);
  link.start();
  EXPECT_TRUE(eventually(is_there));
  link.stop(5.0);
}

}  // namespace
}  // namespace kerf::agent::link_requests_test
