// SPDX-License-Identifier: Apache-2.0
// Datagrams of an agent that uses UDP.
#include "kernel/cut/workers.h"
#include "tests/server/conversation_fixture.h"

namespace kerf::net::agent_datagram_test {
namespace {

using Kind = OutFrame::Kind;

const wire::Result& result_of(const wire::Message& message) {
  return std::get<wire::Result>(message.body);
}

class UdpOffer : public ConversationTest {
 protected:
  /// Returns the first message to an agent with this hello.
  nlohmann::json answer_to(const char* hello) {
    const auto ada = agent();
    send_text(*ada, hello);
    return messages(*ada).at(0);
  }
};

TEST_F(UdpOffer, NeedsARequestAndAPort) {
  EXPECT_FALSE(answer_to(R"({"type":"hello"})").contains("udp"));
  EXPECT_FALSE(answer_to(R"({"type":"hello","udp":false})").contains("udp"));
  EXPECT_EQ(udp_offers, 0) << "no keys are made";
  EXPECT_EQ(answer_to(R"({"type":"hello","udp":true})").at("udp").at("port"), 4000);
  offer.reset();
  const auto none = answer_to(R"({"type":"hello","udp":true})");
  EXPECT_EQ(none.at("type"), "welcome");
  EXPECT_FALSE(none.contains("udp"));
  EXPECT_EQ(answer_to(R"({"type":"hello","udp":"yes"})").at("code"), "bad_message");
}

class AgentDatagramTest : public ConversationTest {
 protected:
  void SetUp() override {
    ConversationTest::SetUp();
    ada = agent();
    send_text(*ada, R"({"type":"hello","tool":1,"udp":true})");
    const auto list = messages(*ada);
    ASSERT_EQ(list.at(0).at("udp").at("connection"), 7);
  }
  std::vector<wire::Message> exchange(const Bytes& frame) {
    std::vector<wire::Message> answers;
    ada->receive_datagram(frame, now);
    while (const OutDatagram* datagram = ada->take_datagram()) {
      sent.emplace_back(datagram->frame().begin(), datagram->frame().end());
      const auto message = wire::decode(sent.back());
      EXPECT_TRUE(message);
      if (message) answers.push_back(*message);
    }
    ada->refresh();
    return answers;
  }
  std::unique_ptr<AgentConversation> ada;
  std::deque<Bytes> sent;
};

TEST_F(AgentDatagramTest, DatagramsNeedAPriorWebSocketSample) {
  const auto answers = exchange(encoded(batch()));
  ASSERT_EQ(answers.size(), 1U);
  EXPECT_TRUE(result_of(answers[0]).status & wire::kStatusGap);
  EXPECT_EQ(result_of(answers[0]).agent_sequence, 0U);
}

TEST_F(AgentDatagramTest, ConsecutiveSamplesAreAppliedAndAnsweredOverUdp) {
  send(*ada, encoded(batch()));
  drain(*ada);
  const auto answers = exchange(encoded(batch(2)));
  ASSERT_EQ(answers.size(), 1U);
  EXPECT_EQ(result_of(answers[0]).agent_sequence, 3U);
  EXPECT_TRUE(drain(*ada).empty());
}

TEST_F(AgentDatagramTest, GapsAndRepetitionsGetThePreviousResult) {
  send(*ada, encoded(batch()));
  const wire::MotionBatch first = batch(2);
  exchange(encoded(first));
  const auto motions = session->info().motions;
  const auto again = exchange(encoded(first));
  ASSERT_EQ(again.size(), 1U);
  EXPECT_EQ(result_of(again[0]).agent_sequence, 3U);
  EXPECT_FALSE(result_of(again[0]).status & wire::kStatusGap);
  batch();  // lost
  const auto gap = exchange(encoded(batch()));
  ASSERT_EQ(gap.size(), 1U);
  EXPECT_EQ(result_of(gap[0]).agent_sequence, 3U);
  EXPECT_TRUE(result_of(gap[0]).status & wire::kStatusGap);
  EXPECT_EQ(result_of(gap[0]).force_n, result_of(again[0]).force_n) << "of before the gap";
  EXPECT_EQ(session->info().motions, motions);
  EXPECT_TRUE(metrics.text(*registry).contains("\nkerf_motion_gaps_total 1\n"));
}

TEST_F(AgentDatagramTest, OldDatagramGetsTheNewestResultAndCutsNothing) {
  send(*ada, encoded(batch()));
  std::vector<wire::MotionBatch> batches;
  for (int n = 0; n < 5; ++n) {
    batches.push_back(batch(2));
    exchange(encoded(batches.back()));
  }
  const auto motions = session->info().motions;
  for (const wire::MotionBatch& old : batches) {
    const auto again = exchange(encoded(old));
    ASSERT_EQ(again.size(), 1U);
    EXPECT_EQ(result_of(again[0]).agent_sequence, 11U);
  }
  EXPECT_EQ(session->info().motions, motions);
}

TEST_F(AgentDatagramTest, MalformedDatagramIsAnErrorOverTheWebSocket) {
  Bytes cut = encoded(batch());
  cut.resize(cut.size() - 8);
  for (const Bytes& wrong : {Bytes(1), Bytes(40), cut}) {
    EXPECT_TRUE(exchange(wrong).empty());
    EXPECT_EQ(error_code(*ada), "bad_frame");
  }
}

TEST_F(AgentDatagramTest, APingIsAnsweredOverUdp) {
  const auto answers = exchange(encoded(wire::Ping{42}));
  ASSERT_EQ(answers.size(), 1U);
  EXPECT_EQ(std::get<wire::Pong>(answers[0].body).ping_time_us, 42U);
}

TEST_F(AgentDatagramTest, ForceOfAnotherParticipantIsSentBeforeTheResult) {
  const auto bob = agent();
  join_agent(*bob, R"({"type":"hello","name":"Bob","udp":true,"feel_of":1})");
  send(*ada, encoded(batch()));
  wire::MotionBatch first;
  first.samples[first.count++] = next(5, 5, -1);
  send(*bob, encoded(first));
  wire::MotionBatch second;
  second.samples[second.count++] = next(5.1, 5, -1);
  bob->receive_datagram(encoded(second), now);
  const OutDatagram* felt = bob->take_datagram();
  ASSERT_NE(felt, nullptr);
  EXPECT_TRUE(std::holds_alternative<wire::ToolStates>(wire::decode(felt->frame())->body));
  EXPECT_FALSE(felt->arrived);
  const OutDatagram* result = bob->take_datagram();
  ASSERT_NE(result, nullptr);
  EXPECT_TRUE(std::holds_alternative<wire::Result>(wire::decode(result->frame())->body));
  EXPECT_TRUE(result->arrived);
  EXPECT_EQ(bob->take_datagram(), nullptr);
}

TEST_F(AgentDatagramTest, QueuedMotionIsAnsweredOverItsTransport) {
  SerialWorkers carvers;
  session->carve_on(carvers);
  const auto bob = agent();
  join_agent(*bob, R"({"type":"hello","name":"Bob"})");
  send(*bob, encoded(batch()));
  const auto answers = [&] {
    EXPECT_TRUE(ada->has_action());
    while (ada->has_action()) ada->work();
    std::vector<std::string> list;
    while (const OutDatagram* datagram = ada->take_datagram()) {
      const auto message = wire::decode(datagram->frame());
      const bool is_answer = result_of(*message).agent_sequence == sequence && datagram->arrived;
      list.emplace_back(is_answer ? "datagram" : "something else");
    }
    for (const OutFrame& frame : drain(*ada)) {
      if (frame.kind == Kind::kResult) list.emplace_back("frame");
    }
    return list;
  };
  for (int n = 0; n < 2; ++n) {
    send(*ada, encoded(batch()));
    EXPECT_EQ(answers(), std::vector<std::string>{"frame"});
    ada->receive_datagram(encoded(batch()), now);
    EXPECT_EQ(ada->take_datagram(), nullptr);
    EXPECT_EQ(answers(), std::vector<std::string>{"datagram"});
  }
}

TEST_F(AgentDatagramTest, PingDuringABatchReservesSpaceForTheResult) {
  SerialWorkers carvers;
  session->carve_on(carvers);
  const auto bob = agent();
  join_agent(*bob, R"({"type":"hello","name":"Bob","udp":true,"feel_of":1})");
  send(*ada, encoded(batch()));
  send(*bob, encoded(batch()));
  while (bob->has_action()) bob->work();
  bob->receive_datagram(encoded(batch()), now);
  bob->receive_datagram(encoded(wire::Ping{42}), now);
  ASSERT_NE(bob->take_datagram(), nullptr);
  ASSERT_TRUE(bob->has_action());
  while (bob->has_action()) bob->work();
  EXPECT_NE(bob->take_datagram(), nullptr) << "the force of Ada";
  EXPECT_NE(bob->take_datagram(), nullptr) << "the result";
  EXPECT_EQ(bob->take_datagram(), nullptr);
}

TEST_F(AgentDatagramTest, DatagramsAreIgnoredAfterTheEnd) {
  send(*ada, encoded(batch()));
  session->close("");
  EXPECT_TRUE(exchange(encoded(batch())).empty());
}

}  // namespace
}  // namespace kerf::net::agent_datagram_test
