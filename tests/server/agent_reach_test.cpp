// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <string>

#include "tests/server/conversation_fixture.h"

namespace kerf::net {
namespace {

using AgentReachTest = ConversationTest;

constexpr const char* kReach = R"({"type":"reach","center_mm":[1,2,3],"half_mm":[60,50,40],
    "turn_rad":[0,0,1.5],"scale":0.5})";

TEST_F(AgentReachTest, ListsOfViewersStateWhereADeviceReachesWhenThatChanges) {
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

TEST_F(AgentReachTest, AReachThatIsNoBoxIsRejected) {
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

}  // namespace
}  // namespace kerf::net
