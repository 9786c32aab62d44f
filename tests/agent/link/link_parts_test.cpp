// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>

#include "haptic_agent/device/ranges.h"
#include "haptic_agent/link/clock_sync.h"
#include "haptic_agent/link/control_message.h"
#include "haptic_agent/link/server_choice.h"
#include "haptic_agent/link/server_url.h"
#include "haptic_agent/link/traffic.h"
#include "server/wire/codec.h"
#include "tests/agent/link/fake_server.h"
#include "tests/support/test.h"

namespace kerf::agent::link_parts_test {
namespace {

TEST(ServerUrl, ReadsHostAndPort) {
  EXPECT_EQ(parse_server_url("http://localhost:9000"), (ServerUrl{"localhost", "9000"}));
  EXPECT_EQ(parse_server_url("ws://10.0.0.1:1/"), (ServerUrl{"10.0.0.1", "1"}));
  EXPECT_EQ(parse_server_url("carve.example"), (ServerUrl{"carve.example", "8080"}));
  EXPECT_EQ(parse_server_url("http://[::1]:81"), (ServerUrl{"::1", "81"}));
  EXPECT_EQ(parse_server_url("http://[::1]:81")->authority(), "[::1]:81");
  EXPECT_EQ(parse_server_url("carve.example")->authority(), "carve.example:8080");
  EXPECT_EQ(parse_server_url("https://carve.example"), (ServerUrl{"carve.example", "443", true}));
  EXPECT_EQ(parse_server_url("wss://[::1]:81"), (ServerUrl{"::1", "81", true}));
}

TEST(ServerUrl, RejectsInvalidAddresses) {
  for (const char* text : {"", "http://", "https://", "ftp://host", "host:0", "host:65536",
                           "host:x", "host:", "host/path", "host?q", "[::1", "[::1]x", ":80"}) {
    EXPECT_FALSE(parse_server_url(text)) << text;
  }
}

TEST(ServerUrl, RedirectDoesNotLeaveTls) {
  const ServerUrl plain{"a", "8080"}, safe{"a", "443", true};
  EXPECT_EQ(follow_redirect(plain, "http://b:81"), (ServerUrl{"b", "81"}));
  EXPECT_EQ(follow_redirect(plain, "https://b"), (ServerUrl{"b", "443", true}));
  EXPECT_EQ(follow_redirect(safe, "https://b:81"), (ServerUrl{"b", "81", true}));
  EXPECT_FALSE(follow_redirect(safe, "http://b:81"));
  EXPECT_FALSE(follow_redirect(plain, ""));
  EXPECT_FALSE(follow_redirect(plain, "ftp://b"));
}

TEST(ServerChoice, EachServerIsTriedBeforeTheFirstIsRetried) {
  ServerChoice choice;
  ServerUrl server{"a", "8080"};
  EXPECT_TRUE(choice.turn(server)) << "there is only one";
  EXPECT_EQ(server.host, "a");
  choice.welcomed(server, {"http://b:81", "ftp://no", "http://c:82"});
  EXPECT_TRUE(choice.has_others());
  EXPECT_FALSE(choice.turn(server));
  EXPECT_EQ(server, (ServerUrl{"b", "81"}));
  EXPECT_FALSE(choice.turn(server));
  EXPECT_EQ(server, (ServerUrl{"c", "82"}));
  EXPECT_TRUE(choice.turn(server));
  EXPECT_EQ(server, (ServerUrl{"a", "8080"}));
  choice.welcomed({"b", "81", true}, {"http://c:82"});
  EXPECT_FALSE(choice.has_others()) << "it would lead out of TLS";
}

TEST(SessionId, AcceptsOnlyNamesThatAreSafeInAPath) {
  EXPECT_TRUE(is_session_id("demo-2.a_B"));
  for (const std::string bad : {"", "..", "a/b", "a b", "ä", "a%2f"}) {
    EXPECT_FALSE(is_session_id(bad)) << bad;
  }
  EXPECT_FALSE(is_session_id(std::string(65, 'a')));
}

TEST(Control, CylinderStockBecomesItsBoundingBox) {
  auto message = nlohmann::json::parse(welcome_text());
  message["stock"] = {{"shape", "cylinder"},
                      {"center_mm", {10, 20}},
                      {"radius_mm", 5},
                      {"min_z_mm", -3},
                      {"max_z_mm", 4}};
  const auto control = test::value_of(parse_control(message.dump()));
  const auto& welcome = std::get<Welcome>(control);
  EXPECT_EQ(welcome.stock.min_mm, (Vec3{5, 15, -3}));
  EXPECT_EQ(welcome.stock.max_mm, (Vec3{15, 25, 4}));
}

TEST(Control, LawsAreRead) {
  const auto law = [](const char* name) {
    auto message = nlohmann::json::parse(welcome_text());
    message["force"] = {{"law", name}};
    return std::get<Welcome>(*parse_control(message.dump())).law;
  };
  EXPECT_EQ(law("mechanistic"), CutLaw::kMechanistic);
  EXPECT_EQ(law("drr"), CutLaw::kRemovalRate);
  EXPECT_EQ(law("specific_energy"), CutLaw::kSpecificEnergy);
  EXPECT_EQ(law("of tomorrow"), CutLaw::kSpecificEnergy) << "its force does not grow with speed";
}

TEST(Control, UnknownMessagesAreIgnoredAndMalformedOnesRejected) {
  EXPECT_TRUE(std::holds_alternative<OtherMessage>(*parse_control(R"({"type":"weather"})")));
  for (const char* text :
       {"", "[]", "{}", R"({"type":5})", R"({"type":"welcome"})", R"({"type":"error"})", "\xff"}) {
    const auto control = parse_control(text);
    ASSERT_FALSE(control) << text;
    EXPECT_EQ(control.error().fault, ControlFault::kMalformed);
  }
}

TEST(Control, AbsurdNumbersInAWelcomeGiveATypedError) {
  const auto fault = [](const char* pointer, const nlohmann::json& value) {
    auto message = nlohmann::json::parse(welcome_text());
    message[nlohmann::json::json_pointer(pointer)] = value;
    return parse_control(message.dump());
  };
  EXPECT_TRUE(fault("/pivot_mm", 0));
  EXPECT_TRUE(fault("/pivot_mm", kPivotMaxMm));
  for (const double pivot_mm : {-1.0, 5001.0, 1e300}) {
    const auto control = fault("/pivot_mm", pivot_mm);
    ASSERT_FALSE(control) << pivot_mm;
    EXPECT_EQ(control.error().fault, ControlFault::kOutOfRange);
    EXPECT_TRUE(control.error().reason.starts_with("pivot_mm must be from 0 to 5000, not "))
        << control.error().reason;
  }
  for (const char* pointer : {"/force/specific_force_n_per_mm2", "/force/drr_n_s_per_mm3"}) {
    const auto control = fault(pointer, -0.5);
    ASSERT_FALSE(control) << pointer;
    EXPECT_EQ(control.error().fault, ControlFault::kOutOfRange);
  }
  EXPECT_FALSE(fault("/stock/min_mm", {1e7, 0, 0}));
  EXPECT_FALSE(fault("/stock/max_mm", {-60, 50, 50})) << "below the lowest corner";
}

TEST(Control, HelloOmitsUnsetFields) {
  const auto hello = nlohmann::json::parse(hello_text({.name = "Ada", .color = "", .tool_id = 0}));
  EXPECT_EQ(hello,
            nlohmann::json::parse(R"({"type":"hello","name":"Ada","feel":true,"durable":true})"));
  EXPECT_EQ(nlohmann::json::parse(hello_text({.name = "", .color = "", .udp = true}))["udp"], true);
  const auto replica = nlohmann::json::parse(hello_text({.name = "", .color = "", .stock = true}));
  for (const char* key : {"stock", "returned", "intent"})
    EXPECT_TRUE(replica.value(key, false)) << key;
}

TEST(Control, TokenIsSentAndRemovedFromTheWelcomeText) {
  const auto hello = nlohmann::json::parse(hello_text({.name = "", .color = "", .resume = "abc"}));
  EXPECT_EQ(hello["resume"], "abc");
  const auto read = [](const nlohmann::json& resume) {
    auto message = nlohmann::json::parse(welcome_text());
    message["resume"] = resume;
    return std::get<Welcome>(parse_control(message.dump()).value());
  };
  const Welcome welcome = read({{"token", "0123abcd"}, {"agent_sequence", 17}, {"resumed", true}});
  ASSERT_TRUE(welcome.resume);
  EXPECT_EQ(welcome.resume->token, "0123abcd");
  EXPECT_EQ(welcome.resume->agent_sequence, 17U);
  EXPECT_TRUE(welcome.resume->resumed);
  EXPECT_EQ(welcome.text.find("0123abcd"), std::string::npos);
  EXPECT_FALSE(read({{"token", 5}, {"agent_sequence", 17}, {"resumed", true}}).resume);
  EXPECT_FALSE(read({{"token", ""}, {"agent_sequence", -1}, {"resumed", true}}).resume);
  EXPECT_FALSE(read(7).resume);
}

TEST(Control, InvalidUdpOfferIsIgnored) {
  const auto offered = [](const nlohmann::json& udp) {
    auto message = nlohmann::json::parse(welcome_text());
    message["udp"] = udp;
    const auto control = parse_control(message.dump());
    EXPECT_TRUE(control) << udp;
    return control ? std::get<Welcome>(*control).udp : std::nullopt;
  };
  const nlohmann::json good = {{"port", 8080},
                               {"connection", 4'000'000'000U},
                               {"cipher", "chacha20-poly1305"},
                               {"key_to_server", std::string(64, '1')},
                               {"key_to_agent", std::string(64, 'f')}};
  ASSERT_TRUE(offered(good));
  EXPECT_EQ(offered(good)->port, 8080);
  EXPECT_EQ(offered(good)->connection, 4'000'000'000U);
  EXPECT_EQ(offered(good)->to_server.front(), std::byte{0x11});
  EXPECT_EQ(offered(good)->to_agent.front(), std::byte{0xFF});
  for (const auto& [field, bad] :
       std::vector<std::pair<std::string, nlohmann::json>>{{"port", "x"},
                                                           {"port", 0},
                                                           {"port", 65'536},
                                                           {"port", -1},
                                                           {"port", nullptr},
                                                           {"connection", "x"},
                                                           {"connection", -1},
                                                           {"connection", 4'294'967'296ULL},
                                                           {"cipher", "rot13"},
                                                           {"cipher", 5},
                                                           {"key_to_server", "1"},
                                                           {"key_to_agent", 7}}) {
    nlohmann::json udp = good;
    udp[field] = bad;
    EXPECT_FALSE(offered(udp)) << udp;
    udp.erase(field);
    EXPECT_FALSE(offered(udp)) << udp;
  }
  for (const nlohmann::json& bad : {nlohmann::json(true), nlohmann::json::array({1, 2})}) {
    EXPECT_FALSE(offered(bad)) << bad;
  }
}

class TrafficTest : public ::testing::Test {
 protected:
  Traffic make(TrafficOptions options = {}) {
    Traffic traffic(ring, wrenches, options);
    traffic.begin(1, 1, now_us);
    return traffic;
  }
  template <typename Body>
  void take(Traffic& traffic, const Body& body) {
    std::vector<std::byte> frame;
    wire::append(frame, {.epoch = 1, .sequence = 1, .time_us = 1}, body);
    ASSERT_FALSE(traffic.take_frame(frame, now_us));
  }
  /// Pushes a pose, 1 ms after the last one. Returns the samples that are sent.
  std::vector<wire::MotionSample> pass(Traffic& traffic, double x_mm, bool cutting) {
    return pass(
        traffic,
        {.tip_mm = {x_mm, 0, 0}, .tool_id = 1, .buttons = cutting ? wire::kButtonCutting : 0U});
  }
  std::vector<wire::MotionSample> pass(Traffic& traffic, wire::MotionSample sample) {
    now_us += 1000;
    sample.time_us = now_us;
    EXPECT_TRUE(ring.push(sample));
    traffic.collect();
    std::vector<wire::MotionSample> sent;
    std::array<std::byte, wire::kMaxClientFrameBytes> frame;
    while (const std::size_t bytes = traffic.fill(now_us, frame)) {
      const auto message = wire::decode(std::span(frame).first(bytes));
      const auto* batch = std::get_if<wire::MotionBatch>(&message->body);
      if (batch != nullptr) sent.insert(sent.end(), batch->view().begin(), batch->view().end());
    }
    return sent;
  }

  SampleRing ring;
  LatestValue<ServerWrench> wrenches;
  std::uint64_t now_us = 1'000'000;
};

TEST_F(TrafficTest, DeadbandDropsMostPosesOutOfContactButKeepsAHeartbeat) {
  Traffic traffic = make({.deadband = true});
  EXPECT_EQ(pass(traffic, 0, false).size(), 1U);
  EXPECT_EQ(pass(traffic, 0.001, false).size(), 1U) << "contact is possible until the first answer";
  take(traffic, wire::Result{.agent_sequence = 2});
  std::size_t sent = 0;
  double last_mm = 0.001, worst_mm = 0;
  for (int i = 0; i < 1000; ++i) {
    const double x_mm = 0.001 + 0.004 * (i + 1);  // 4 mm/s
    for (const auto& sample : pass(traffic, x_mm, false)) {
      ++sent;
      last_mm = sample.tip_mm.x;
      take(traffic, wire::Result{.agent_sequence = sample.agent_sequence});
    }
    worst_mm = std::max(worst_mm, x_mm - last_mm);
  }
  EXPECT_LE(sent, 200U) << "four fifths dropped";
  EXPECT_GE(sent, 100U) << "at least one per 10 ms";
  EXPECT_LE(worst_mm, 0.05);
  EXPECT_EQ(traffic.report().held_back, 1000 - sent);
}

TEST_F(TrafficTest, CutAfterDroppedPosesStartsAtTheLastMeasuredPose) {
  Traffic traffic = make({.deadband = true});
  pass(traffic, 0, false);
  take(traffic, wire::Result{.agent_sequence = 1});
  EXPECT_TRUE(pass(traffic, 0.02, false).empty());
  const auto sent = pass(traffic, 0.03, true);
  ASSERT_EQ(sent.size(), 2U);
  EXPECT_EQ(sent[0].tip_mm.x, 0.02);
  EXPECT_EQ(sent[1].tip_mm.x, 0.03);
}

TEST_F(TrafficTest, CountsResultsWithAnImprint) {
  Traffic traffic = make({});
  pass(traffic, 0, true);
  take(traffic,
       wire::Result{.agent_sequence = 1, .status = wire::kStatusCutting | wire::kStatusImprint});
  pass(traffic, 0.1, true);
  take(traffic, wire::Result{.agent_sequence = 2, .status = wire::kStatusCutting});
  EXPECT_EQ(traffic.report().imprint_results, 1U);
}

TEST_F(TrafficTest, DeadbandIsInactiveInContact) {
  Traffic traffic = make({.deadband = true});
  pass(traffic, 0, false);
  wire::Result result{.agent_sequence = 1};
  result.plane_count = 1;
  take(traffic, result);
  EXPECT_EQ(pass(traffic, 0, false).size(), 1U);
  take(traffic, wire::Result{.agent_sequence = 2, .status = wire::kStatusCutting});
  EXPECT_EQ(pass(traffic, 0, false).size(), 1U);
  take(traffic, wire::Result{.agent_sequence = 3});
  EXPECT_TRUE(pass(traffic, 0, false).empty());
  EXPECT_EQ(pass(traffic, 0, true).size(), 2U);
  EXPECT_EQ(pass(traffic, 0, true).size(), 1U) << "a cutting sample is never dropped";
}

TEST_F(TrafficTest, DeadbandKeepsPosesWithOtherButtonsAxisOrTool) {
  const wire::MotionSample rest{.axis = {0, 0, 1}, .tool_id = 1};
  wire::MotionSample held = rest, leaning = rest, other_tool = rest;
  held.buttons = wire::kButtonDeadman;
  leaning.axis = {0.002F, 0, 1};
  other_tool.tool_id = 2;
  for (const wire::MotionSample& changed : {held, leaning, other_tool}) {
    Traffic traffic = make({.deadband = true});
    pass(traffic, rest);
    take(traffic, wire::Result{.agent_sequence = 1});
    EXPECT_TRUE(pass(traffic, rest).empty());
    EXPECT_EQ(pass(traffic, changed).size(), 1U);
  }
}

TEST_F(TrafficTest, ForwardsTheWrenchOfTheFollowedParticipant) {
  Traffic traffic = make();
  wire::ToolState other{.force_n = {1, 2, 3}, .torque_nmm = {4, 5, 6}};
  take(traffic, wire::ToolStates{{other}});
  take(traffic, wire::Result{.agent_sequence = 1});
  ServerWrench answer;
  ASSERT_TRUE(wrenches.read(answer));
  EXPECT_EQ(answer.felt, (Wrench{{1, 2, 3}, {4, 5, 6}}));
  EXPECT_EQ(answer.wrench, Wrench{});
}

TEST_F(TrafficTest, DoesNotAcknowledgeStockOfAnEarlierConnection) {
  Traffic traffic = make();
  const auto acks = [&] {
    std::size_t count = 0;
    std::array<std::byte, wire::kMaxClientFrameBytes> frame;
    while (const std::size_t bytes = traffic.fill(now_us, frame)) {
      count += std::holds_alternative<wire::Ack>(wire::decode(std::span(frame).first(bytes))->body);
    }
    return count;
  };
  take(traffic, wire::StockPatch{.reset = true, .tiles = {}});
  EXPECT_EQ(acks(), 1U);
  take(traffic, wire::StockPatch{.reset = true, .tiles = {}});
  traffic.begin(2, 1, now_us);
  EXPECT_EQ(acks(), 0U) << "the server would answer bad_sequence: it has sent no stock";
}

TEST_F(TrafficTest, WritesStatusUpdates) {
  LatestValue<LinkStatus> status;
  Traffic traffic = make({.status = &status});
  now_us += 40'000;
  take(traffic, wire::Pong{.ping_time_us = now_us - 30'000, .time_us = 5'000'000});
  LinkStatus now;
  ASSERT_TRUE(status.read(now));
  EXPECT_EQ(now.rtt_us, 30'000U);
  EXPECT_EQ(now.connections, 1U);
}

TEST(ClockSync, ShortestRoundTripGivesTheOffset) {
  ClockSync sync;
  sync.take(1000, 501'500, 2000);
  EXPECT_EQ(sync.offset_us(), 500'000);
  sync.take(2000, 503'000, 12'000);
  EXPECT_EQ(sync.offset_us(), 500'000) << "a longer round trip does not count";
  sync.take(3000, 503'150, 3100);
  EXPECT_EQ(sync.offset_us(), 500'100);
  sync.take(5000, 1, 4000);
  EXPECT_EQ(sync.rtt_us().total(), 3U) << "a pong that arrives before its ping was sent is ignored";
}

}  // namespace
}  // namespace kerf::agent::link_parts_test
