// SPDX-License-Identifier: Apache-2.0
#include "tests/server/conversation_fixture.h"
#include "tests/support/test.h"

namespace kerf::net::agent_reach_test {
namespace {

using AgentReachTest = ConversationTest;

constexpr const char* kReach = R"({"type":"reach","center_mm":[1,2,3],"half_mm":[60,50,40],
    "turn_rad":[0,0,1.5],"scale":0.5})";

TEST_F(AgentReachTest, ViewersSeeChangesOfADevicesReach) {
  const auto ada = agent();
  send_text(*ada, R"({"type":"hello","name":"Ada","reach":true})");
  EXPECT_EQ(messages(*ada).at(0).at("reach"), true) << "the welcome offers it";
  Roster before = session->roster();
  // Returns the change since the last call as viewers receive it.
  const auto change = [&] {
    const Roster now_there = session->roster();
    const auto message = nlohmann::json::parse(change_message(difference(before, now_there)));
    before = now_there;
    return message;
  };
  send_text(*ada, kReach);
  const auto entry = change().at("changed").at(0);
  EXPECT_EQ(entry.at("name"), "Ada");
  EXPECT_EQ(entry.at("reach"), nlohmann::json::parse(R"({"center_mm":[1.0,2.0,3.0],
      "half_mm":[60.0,50.0,40.0],"turn_rad":[0.0,0.0,1.5],"scale":0.5})"));
  send_text(*ada, kReach);
  EXPECT_FALSE(change().contains("changed")) << "nothing has changed";
  send_text(*ada, R"({"type":"reach"})");
  EXPECT_FALSE(change().at("changed").at(0).contains("reach"));
  EXPECT_TRUE(messages(*ada).empty()) << "neither an answer nor an error";
}

TEST_F(AgentReachTest, InvalidReachIsRejected) {
  const auto ada = agent();
  join_agent(*ada);
  const auto reason = [&](const std::string& fields) {
    send_text(*ada, R"({"type":"reach",)" + fields + "}");
    const auto answers = messages(*ada);
    return answers.empty() ? std::string("accepted") : answers[0].at("reason").get<std::string>();
  };
  EXPECT_EQ(reason(R"("center_mm":[0,0,0])"), "field \"half_mm\" must be three numbers");
  EXPECT_EQ(reason(R"("half_mm":[1,1,1])"), "field \"center_mm\" must be three numbers");
  EXPECT_EQ(reason(R"("center_mm":[0,0,2e6],"half_mm":[1,1,1])"),
            "field \"center_mm\" is out of range");
  EXPECT_EQ(reason(R"("center_mm":[0,0,0],"half_mm":[1,0,1])"),
            "field \"half_mm\" must be greater than zero");
  EXPECT_EQ(reason(R"("center_mm":[0,0,0],"half_mm":[1,1,1],"turn_rad":[0,8,0])"),
            "field \"turn_rad\" is out of range");
  EXPECT_EQ(reason(R"("center_mm":[0,0,0],"half_mm":[1,1,1],"scale":0)"),
            "field \"scale\" is out of range");
  EXPECT_EQ(reason(R"("center_mm":[0,0,0],"half_mm":[1,1,1])"), "accepted");
}

/// In 3 s a burst of 30 and 10 per second are accepted: 60 of 100. Changes of the tool have a limit
/// of their own.
TEST_F(AgentReachTest, ReachesAreLimitedToTenPerSecond) {
  const auto ada = agent();
  join_agent(*ada);
  std::size_t accepted = 0, errors = 0;
  for (int n = 1; n <= 100; ++n) {
    now += std::chrono::milliseconds(30);
    send_text(*ada,
              R"({"type":"reach","half_mm":[1,1,1],"center_mm":[0,0,)" + std::to_string(n) + "]}");
    const auto answers = messages(*ada);
    const auto& reach = session->participants().front().reach;
    if (answers.empty()) {
      ASSERT_TRUE(reach.has_value());
      EXPECT_EQ(reach->center_mm.z, n);
      ++accepted;
      continue;
    }
    EXPECT_EQ(answers.at(0).at("code"), "too_fast");
    EXPECT_EQ(answers.at(0).at("reason"), "'reach' is limited to 10 per second");
    EXPECT_NE(reach->center_mm.z, n) << "a rejected reach changes nothing";
    ++errors;
  }
  EXPECT_GE(errors, 39U);
  EXPECT_LE(errors, 41U);
  EXPECT_EQ(accepted + errors, 100U);
  send_text(*ada, R"({"type":"tool","tool":2})");
  for (const auto& message : messages(*ada)) EXPECT_NE(message.at("type"), "error");
}

}  // namespace
}  // namespace kerf::net::agent_reach_test
