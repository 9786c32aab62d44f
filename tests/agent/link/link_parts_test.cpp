#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "haptic_agent/link/clock_sync.h"
#include "haptic_agent/link/control_message.h"
#include "haptic_agent/link/pace.h"
#include "haptic_agent/link/server_url.h"
#include "haptic_agent/link/traffic.h"
#include "tests/agent/link/fake_server.h"

namespace kerf::agent {
namespace {

TEST(ServerUrl, ReadsHostAndPort) {
  EXPECT_EQ(parse_server_url("http://localhost:9000"), (ServerUrl{"localhost", "9000"}));
  EXPECT_EQ(parse_server_url("ws://10.0.0.1:1/"), (ServerUrl{"10.0.0.1", "1"}));
  EXPECT_EQ(parse_server_url("carve.example"), (ServerUrl{"carve.example", "8080"}));
  EXPECT_EQ(parse_server_url("http://[::1]:81"), (ServerUrl{"::1", "81"}));
}

TEST(ServerUrl, RefusesWhatItCannotReach) {
  for (const char* text :
       {"", "http://", "https://host", "wss://host", "ftp://host", "host:0", "host:65536", "host:x",
        "host:", "host/path", "host?q", "[::1", "[::1]x", ":80"}) {
    EXPECT_FALSE(parse_server_url(text)) << text;
  }
}

TEST(SessionId, TakesOnlyNamesThatAreSafeInAPath) {
  EXPECT_TRUE(is_session_id("demo-2.a_B"));
  for (const std::string bad : {"", "..", "a/b", "a b", "ä", "a%2f"}) {
    EXPECT_FALSE(is_session_id(bad)) << bad;
  }
  EXPECT_FALSE(is_session_id(std::string(65, 'a')));
}

TEST(Control, AWelcomeWithACylinderGivesTheBoxAroundIt) {
  auto message = nlohmann::json::parse(welcome_text());
  message["stock"] = {{"shape", "cylinder"},
                      {"center_mm", {10, 20}},
                      {"radius_mm", 5},
                      {"min_z_mm", -3},
                      {"max_z_mm", 4}};
  const auto control = parse_control(message.dump());
  ASSERT_TRUE(control);
  const auto& welcome = std::get<Welcome>(*control);
  EXPECT_EQ(welcome.stock.min_mm, (Vec3{5, 15, -3}));
  EXPECT_EQ(welcome.stock.max_mm, (Vec3{15, 25, 4}));
}

TEST(Control, UnknownMessagesAreSkippedAndMalformedOnesRefused) {
  EXPECT_TRUE(std::holds_alternative<OtherMessage>(*parse_control(R"({"type":"weather"})")));
  for (const char* text :
       {"", "[]", "{}", R"({"type":5})", R"({"type":"welcome"})", R"({"type":"error"})", "\xff"}) {
    EXPECT_FALSE(parse_control(text)) << text;
  }
}

TEST(Control, AHelloLeavesOutWhatTheServerIsToPick) {
  const auto hello = nlohmann::json::parse(hello_text({.name = "Ada", .color = "", .tool_id = 0}));
  EXPECT_EQ(hello, nlohmann::json::parse(R"({"type":"hello","name":"Ada","feel":true})"));
}

TEST(Declined, OnlyTheAgentsOwnFaultsAreFinal) {
  EXPECT_TRUE(declined("demo", 404, "").final);
  EXPECT_FALSE(declined("demo", 429, "").final);
  EXPECT_FALSE(declined("demo", 503, "").final);
  EXPECT_EQ(declined("demo", 403, "not\nyours\n").reason,
            "the server refuses session 'demo': HTTP 403: notyours");
  EXPECT_LT(declined("demo", 500, std::string(10'000, 'x')).reason.size(), 300U);
}

TEST(Pace, LetsABacklogOutALittleFasterThanItGrows) {
  Pace pace;
  std::uint64_t now_us = 1'000'000;
  std::size_t sent = pace.allowed(now_us);
  EXPECT_EQ(sent, 900U);
  pace.sent(sent);
  EXPECT_EQ(pace.allowed(now_us), 0U);
  for (int i = 0; i < 1000; ++i) {
    now_us += 10'000;
    const std::size_t now = pace.allowed(now_us);
    pace.sent(now);
    sent += now;
  }
  EXPECT_NEAR(static_cast<double>(sent), 900 + 12'250, 2);
}

TEST(ClockSync, TheQuickestAnswerKnowsTheOffset) {
  ClockSync sync;
  sync.take(1000, 501'500, 2000);
  EXPECT_EQ(sync.offset_us(), 500'000);
  sync.take(2000, 503'000, 12'000);
  EXPECT_EQ(sync.offset_us(), 500'000) << "a slow answer says little";
  sync.take(3000, 503'150, 3100);
  EXPECT_EQ(sync.offset_us(), 500'100);
  sync.take(5000, 1, 4000);
  EXPECT_EQ(sync.rtt_us().total(), 3U) << "an answer from before the question is none";
}

}  // namespace
}  // namespace kerf::agent
