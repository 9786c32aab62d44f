// SPDX-License-Identifier: Apache-2.0
#include "server/conversation/agent_conversation.h"

#include <algorithm>

#include "tests/server/conversation_fixture.h"

namespace kerf::net::agent_conversation_test {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using Kind = OutFrame::Kind;

class AgentConversationTest : public ConversationTest {};

const wire::Result& result_of(const wire::Message& message) {
  return std::get<wire::Result>(message.body);
}

TEST_F(AgentConversationTest, FramesOfAnotherEpochHaveNoEffect) {
  const auto ada = agent();
  join_agent(*ada, R"({"type":"hello","udp":true})");
  const std::uint64_t before = session->sequence();
  for (const std::uint32_t epoch : {kEpoch - 1, kEpoch + 1}) {
    const std::uint64_t last = sequence;
    send(*ada, encoded(batch(4), 1, epoch));
    EXPECT_EQ(error_code(*ada), "bad_epoch");
    ada->receive_datagram(encoded(batch(4), 1, epoch), now);
    EXPECT_EQ(ada->take_datagram(), nullptr);
    EXPECT_EQ(error_code(*ada), "bad_epoch");
    sequence = last;
  }
  EXPECT_EQ(session->sequence(), before);
  EXPECT_TRUE(std::ranges::none_of(
      drain(*ada), [](const OutFrame& frame) { return frame.kind == OutFrame::Kind::kResult; }));
  send(*ada, encoded(wire::Ping{7}, 1, kEpoch + 1));
  EXPECT_EQ(drain(*ada).size(), 1U) << "pings measure the time in any epoch";
  send(*ada, encoded(batch(4)));
  EXPECT_EQ(session->sequence(), before + 3);
}

TEST_F(AgentConversationTest, HelloGetsWelcomeAndParticipants) {
  const auto ada = agent();
  send_text(*ada, R"({"type":"hello","name":"Ada","tool":1})");
  const auto list = messages(*ada);
  ASSERT_EQ(list.size(), 2U);
  EXPECT_EQ(list[0].at("type"), "welcome");
  EXPECT_EQ(list[0].at("participant"), 1);
  EXPECT_FALSE(list[0].contains("udp"));
  EXPECT_EQ(list[1].at("type"), "participants");
}

TEST_F(AgentConversationTest, MessagesBeforeTheHelloAreRejected) {
  const auto ada = agent();
  send_text(*ada, R"({"type":"tool","tool":2})");
  EXPECT_EQ(error_code(*ada), "no_hello");
  send(*ada, encoded(batch()));
  EXPECT_EQ(error_code(*ada), "no_hello");
  send(*ada, encoded(wire::Ack{}));
  EXPECT_EQ(error_code(*ada), "no_hello");
  EXPECT_EQ(session->info().motions, 0U);
}

TEST_F(AgentConversationTest, EachMistakeHasItsErrorText) {
  const auto ada = agent();
  join_agent(*ada);
  const auto reason = [&] { return messages(*ada).at(0).at("reason").get<std::string>(); };
  send_text(*ada, R"({"type":"hello"})");
  EXPECT_EQ(reason(), "hello may be sent only once");
  send_text(*ada, R"({"type":"look","eye_mm":[0,0,9],"error_rad":0.1})");
  EXPECT_EQ(reason(), "agents may not send 'look' and 'seek' messages");
  send(*ada, encoded(wire::Result{}));
  EXPECT_EQ(reason(), "agents may not send frames of type 2");
  send(*ada, Bytes(wire::kMaxClientFrameBytes + 1));
  EXPECT_EQ(reason(), "the frame has 4097 bytes; the limit is 4096");
}

TEST_F(AgentConversationTest, MissingHelloEndsTheConversation) {
  const auto ada = agent();
  ada->hello_expired();
  EXPECT_TRUE(ada->finishing());
  const auto list = messages(*ada);
  ASSERT_EQ(list.size(), 1U);
  EXPECT_EQ(list[0].at("code"), "no_hello");
  EXPECT_EQ(list[0].at("fatal"), true);
}

TEST_F(AgentConversationTest, AnExpiredHelloTimerHasNoEffectOnAParticipant) {
  const auto ada = agent();
  join_agent(*ada);
  ada->hello_expired();
  EXPECT_FALSE(ada->finishing());
  EXPECT_TRUE(drain(*ada).empty());
}

TEST_F(AgentConversationTest, EachBatchGetsOneResult) {
  const auto ada = agent();
  join_agent(*ada);
  send(*ada, encoded(batch(3)));
  const auto frames = drain(*ada);
  ASSERT_EQ(frames.size(), 1U);
  EXPECT_EQ(frames[0].kind, Kind::kResult);
  const auto message = wire::decode(frames[0].bytes);
  ASSERT_TRUE(message);
  EXPECT_EQ(result_of(*message).agent_sequence, 3U);
  EXPECT_EQ(result_of(*message).motions_applied, 2U);
}

TEST_F(AgentConversationTest, AFullControlQueueBreaksTheConnection) {
  const auto ada = agent();
  join_agent(*ada);
  for (int n = 0; n < 200 && !ada->broken(); ++n) {
    now += seconds(1);  // below the limit of reported errors
    send_text(*ada, "not JSON");
  }
  EXPECT_TRUE(ada->broken());
  send(*ada, encoded(batch()));
  EXPECT_EQ(session->info().motions, 0U);
}

TEST_F(AgentConversationTest, EndOfTheSessionSendsABye) {
  const auto ada = agent();
  join_agent(*ada);
  send(*ada, encoded(batch()));
  session->close("maintenance");
  EXPECT_GT(wakes, 0);
  EXPECT_TRUE(ada->finishing());
  const auto list = messages(*ada);
  ASSERT_EQ(list.size(), 1U);
  EXPECT_EQ(list[0].at("type"), "bye");
  EXPECT_EQ(list[0].at("reason"), "maintenance");
}

TEST_F(AgentConversationTest, RemovedAgentLeavesBeforeItsConnectionEnds) {
  const auto ada = agent(), bob = agent();
  join_agent(*ada);
  join_agent(*bob, R"({"type":"hello","name":"Bob"})");
  ASSERT_TRUE(session->people().remove(1, "enough"));
  EXPECT_EQ(session->info().participants.size(), 1U);
  EXPECT_EQ(error_code(*ada), "removed");
  EXPECT_TRUE(ada->finishing());
  ada->end();
  EXPECT_EQ(session->info().participants.size(), 1U);
}

TEST_F(AgentConversationTest, MotionOfARemovedAgentIsCompleted) {
  std::string fine = kScene;  // tiles of 0.96 mm: one motion is the work of several turns
  fine.replace(fine.find("0.5"), 3, "0.03");
  session = *registry->create("fine", fine, {});
  const auto ada = agent();
  join_agent(*ada);
  wire::MotionBatch plunge;
  for (const double z : {1.0, -2.0}) plunge.samples.at(plunge.count++) = next(0, 0, z);
  send(*ada, encoded(plunge));
  ASSERT_TRUE(ada->has_action());
  ASSERT_TRUE(session->is_between_records());
  ASSERT_TRUE(session->people().remove(1, "enough"));
  EXPECT_FALSE(ada->has_action());
  executor->run();
  EXPECT_FALSE(session->is_between_records());
}

/// A cluster of which this server knows the servers in `others`.
class Places final : public SessionPlaces {
 public:
  std::vector<std::string> others;

  std::expected<void, std::string> claim(const std::string&, bool) override { return {}; }
  bool is_taken(const std::string&) const override { return false; }
  std::shared_ptr<const WriteFence> fence(const std::string&) const override { return nullptr; }
  std::uint32_t epoch(const std::string&) const override { return 1; }
  std::expected<void, std::string> close(const std::string&) override { return {}; }
  void give_up(const std::string&) override {}
  const std::string& node() const override { return node_; }
  std::vector<PlacedSession> elsewhere() const override { return {}; }
  std::optional<std::string> address_of(const std::string&) const override { return {}; }
  bool is_moving(const std::string&) const override { return false; }
  std::optional<std::string> needed_server(const std::string&) const override { return {}; }
  std::vector<std::string> other_servers() const override { return others; }
  std::optional<std::string> place_for_new() override { return {}; }
  bool wants_to_follow(const std::string&) override { return false; }

 private:
  std::string node_ = "a";
};

/// At the start of a cluster its servers do not know each other yet.
TEST_F(AgentConversationTest, LearnsOfServersThatAppearAfterItsWelcome) {
  Places places;
  session->place_in(&places, false);
  const auto ada = agent();
  join_agent(*ada);
  const auto heard_after = [&](std::vector<std::string> others) {
    places.others = std::move(others);
    now += AgentConversation::kServersInterval;
    send(*ada, encoded(wire::Ping{}));
    std::vector<std::vector<std::string>> lists;
    for (const auto& message : messages(*ada)) {
      if (message.at("type") == "servers") lists.push_back(message.at("others"));
    }
    return lists;
  };
  using Lists = std::vector<std::vector<std::string>>;
  EXPECT_EQ(heard_after({}), Lists{});
  EXPECT_EQ(heard_after({"http://b:1"}), (Lists{{"http://b:1"}}));
  EXPECT_EQ(heard_after({"http://b:1"}), Lists{}) << "it knows them";
  EXPECT_EQ(heard_after({}), Lists{}) << "this server may be cut off";
  EXPECT_EQ(heard_after({"http://b:1", "http://c:1"}), (Lists{{"http://b:1", "http://c:1"}}));
}

TEST_F(AgentConversationTest, ParticipantsAreReportedToEachOther) {
  const auto ada = agent(), bob = agent();
  join_agent(*ada);
  join_agent(*bob, R"({"type":"hello","name":"Bob"})");
  executor->run_delayed();
  EXPECT_EQ(messages(*ada).back().at("participants").size(), 2U);
  bob->end();
  executor->run_delayed();
  EXPECT_EQ(messages(*ada).back().at("participants").size(), 1U);
}

TEST_F(AgentConversationTest, ViewersAreNotInTheListsOfAgents) {
  const auto ada = agent();
  join_agent(*ada);
  const auto eve = viewer();
  join_viewer(*eve);
  executor->run_delayed();
  EXPECT_TRUE(messages(*ada).empty());
  const auto bob = agent();
  join_agent(*bob, R"({"type":"hello","name":"Bob"})");
  executor->run_delayed();
  const auto list = messages(*ada);
  ASSERT_EQ(list.size(), 1U);
  for (const auto& participant : list[0].at("participants")) {
    EXPECT_EQ(participant.at("kind"), "agent");
  }
}

TEST_F(AgentConversationTest, StalledAgentSurvivesAnyNumberOfToolChanges) {
  const auto ada = agent(), bob = agent();
  join_agent(*ada);
  join_agent(*bob, R"({"type":"hello","name":"Bob"})");
  for (int n = 0; n < 1000; ++n) {
    now += milliseconds(100);
    send_text(*bob, n % 2 == 0 ? R"({"type":"tool","tool":2})" : R"({"type":"tool","tool":1})");
    EXPECT_TRUE(messages(*bob).size() <= 1U);
    executor->run_delayed();
  }
  EXPECT_FALSE(ada->broken());
  const auto list = messages(*ada);
  ASSERT_EQ(list.size(), 1U) << "a newer list replaces one that has not left";
  EXPECT_EQ(list[0].at("participants").at(1).at("tool"), 1);
}

TEST_F(AgentConversationTest, ToolChangesAreLimitedToTenPerSecond) {
  const auto ada = agent();
  join_agent(*ada);
  std::size_t errors = 0;
  for (int ms = 0; ms < 3000; ms += 30) {
    now += milliseconds(30);
    send_text(*ada, ms % 60 == 0 ? R"({"type":"tool","tool":2})" : R"({"type":"tool","tool":1})");
    for (const auto& message : messages(*ada)) {
      if (message.at("type") != "error") continue;
      EXPECT_EQ(message.at("code"), "too_fast");
      ++errors;
    }
  }
  EXPECT_GE(errors, 39U);
  EXPECT_LE(errors, 41U);
}

}  // namespace
}  // namespace kerf::net::agent_conversation_test
