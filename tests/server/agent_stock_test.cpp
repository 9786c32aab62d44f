// SPDX-License-Identifier: Apache-2.0
// Updates of an agent's replica.
#include <cmath>
#include <memory>
#include <optional>
#include <string_view>

#include "server/conversation/agent_conversation.h"
#include "tests/server/conversation_fixture.h"

namespace kerf::net::agent_stock_test {
namespace {

using std::chrono::milliseconds;
using Kind = OutFrame::Kind;

class AgentStockTest : public ConversationTest {};

TEST_F(AgentStockTest, TheReplicaIsUpdatedAtMostEveryTwentyMilliseconds) {
  const auto ada = agent();
  join_agent(*ada, R"({"type":"hello","stock":true})");
  const ParticipantId other = join(*session, "Bob");
  drain(*ada);
  std::size_t patches = 0;
  std::uint64_t acked = 0;
  for (int ms = 0; ms < 400; ++ms) {
    now += milliseconds(1);
    // Keeps changing the stock. Otherwise the replica would soon be complete.
    move(*session, other, -15 + 0.09 * ms, 1 + std::sin(0.3 * ms), -1.5 - 0.002 * ms);
    wire::MotionBatch moves;
    moves.samples.at(moves.count++) = next(-19 + 0.09 * ms, 0, -1);
    send(*ada, encoded(moves));
    for (const OutFrame& frame : drain(*ada)) {
      if (frame.kind != Kind::kStock) continue;
      ++patches;
      acked = wire::decode(frame.bytes)->header.stamp.sequence;
      send(*ada, encoded(wire::Ack{}, acked));
    }
  }
  EXPECT_GE(patches, 10U);
  EXPECT_LE(patches, 21U);
  send(*ada, encoded(wire::Ack{}, acked + 5));
  EXPECT_EQ(error_code(*ada), "bad_sequence");
}

class ReplicaTest : public ConversationTest {
 protected:
  void SetUp() override {
    ConversationTest::SetUp();
    ada = agent();
    join_agent(*ada, hello);
    other = join(*session, "Bob");
    drain(*ada);
    cut(0);  // only places the tool
    sample();
    while (const auto frame = stock_frame()) {
      now += AgentConversation::kStockInterval;
      send(*ada, encoded(wire::Ack{}, *frame));
    }
    now += AgentConversation::kStockInterval;
  }
  void sample() {
    wire::MotionBatch moves;
    moves.samples.at(moves.count++) = next(0, 0, -1);
    send(*ada, encoded(moves));
  }
  /// Lets the other participant cut next to the tool.
  void cut(int n) { move(*session, other, -2 + 0.2 * n, 1, -1.5 - 0.01 * n); }
  /// Returns the number of the stock frame sent, if any.
  std::optional<std::uint64_t> stock_frame() {
    std::optional<std::uint64_t> number;
    for (const OutFrame& frame : drain(*ada)) {
      if (frame.kind == Kind::kStock) number = wire::decode(frame.bytes)->header.stamp.sequence;
    }
    return number;
  }
  std::string_view hello = R"({"type":"hello","stock":true})";
  std::unique_ptr<AgentConversation> ada;
  ParticipantId other = 0;
};

/// An agent with a replica of the whole block.
class CopyTest : public ReplicaTest {
 protected:
  CopyTest() { hello = R"({"type":"hello","stock":true,"whole":true})"; }
};

TEST_F(CopyTest, CutsAreSentBetweenAToolChangeAndTheNextSample) {
  cut(1);
  send_text(*ada, R"({"type":"tool","tool":2})");
  send(*ada, encoded(wire::Ping{}));
  EXPECT_TRUE(stock_frame());
}

TEST_F(ReplicaTest, CutBetweenUpdatesIsSentWithTheNextOne) {
  cut(1);
  sample();
  ASSERT_TRUE(stock_frame());
  cut(2);
  now += AgentConversation::kStockInterval / 4;
  sample();
  EXPECT_FALSE(stock_frame());
  // From now on the agent only sends pings.
  now += AgentConversation::kStockInterval;
  send(*ada, encoded(wire::Ping{}));
  EXPECT_TRUE(stock_frame());
}

TEST_F(ReplicaTest, CutIsSentOnceAnEarlierFrameIsAcknowledged) {
  std::uint64_t sent = 0;
  int n = 1;
  for (bool more = true; more;) {  // until the maximum number of frames is in flight
    cut(n++);
    sample();
    const auto frame = stock_frame();
    more = frame.has_value() && n < 100;
    if (frame) sent = *frame;
    now += AgentConversation::kStockInterval;
  }
  ASSERT_GT(n, 2);
  ASSERT_LT(n, 100);
  send(*ada, encoded(wire::Ack{}, sent));
  EXPECT_TRUE(stock_frame());
}

}  // namespace
}  // namespace kerf::net::agent_stock_test
