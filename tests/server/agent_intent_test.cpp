// SPDX-License-Identifier: Apache-2.0
// The poses of nearby tools, which are sent to an agent before the tiles that these tools cut.
#include "tests/server/conversation_fixture.h"

namespace kerf::net::agent_intent_test {
namespace {

using std::chrono::milliseconds;

class AgentIntentTest : public ConversationTest {
 protected:
  void begin(std::string_view hello) {
    ada = agent();
    join_agent(*ada, hello);
    bob = join(*session, "Bob");
    drain(*ada);
  }
  /// Ada cuts at x = -10, Bob at `x_mm` a millisecond later. Returns the poses sent to Ada.
  std::vector<wire::Intents> step(double x_mm) {
    now += milliseconds(1);
    y_mm += 0.01;
    move(*session, bob, x_mm, y_mm, -1);
    wire::MotionBatch moves;
    moves.samples.at(moves.count++) = next(-10, y_mm, -1);
    send(*ada, encoded(moves));
    std::vector<wire::Intents> sent;
    for (const OutFrame& frame : drain(*ada)) {
      if (frame.kind != OutFrame::Kind::kIntent) continue;
      sent.push_back(std::get<wire::Intents>(wire::decode(frame.bytes)->body));
    }
    return sent;
  }
  std::unique_ptr<AgentConversation> ada;
  ParticipantId bob = 0;
  double y_mm = 0;
};

TEST_F(AgentIntentTest, NearbyToolIsSentAtMostEveryTenMilliseconds) {
  begin(R"({"type":"hello","intent":true})");
  step(0);
  std::vector<wire::Intents> all;
  for (int ms = 0; ms < 100; ++ms) {
    for (const wire::Intents& sent : step(0)) {
      ASSERT_EQ(sent.count, 1U);
      const wire::Intent& tool = sent.tools[0];
      EXPECT_EQ(tool.participant, bob);
      EXPECT_EQ(tool.tool_id, 1U);
      EXPECT_NEAR(tool.tip_mm.y, y_mm, 1e-3) << "the newest pose";
      EXPECT_EQ(tool.time_us + 1000, tool.agent_time_us) << "Ada's newest sample is Bob's next";
      EXPECT_EQ(tool.status, wire::kStatusCutting);
      all.push_back(sent);
    }
  }
  EXPECT_EQ(all.size(), 10U);
}

TEST_F(AgentIntentTest, DepartedToolIsNotListed) {
  begin(R"({"type":"hello","intent":true})");
  step(0);
  for (int ms = 0; ms < 20; ++ms) step(0);
  // A distance of 26 mm between the tools leaves 16 mm between the balls. Then 31 mm.
  move(*session, bob, 31, y_mm, -1);
  int frames = 0;
  for (int ms = 0; ms < 40; ++ms) {
    for (const wire::Intents& sent : step(31)) {
      EXPECT_EQ(sent.count, 0U);
      ++frames;
    }
  }
  EXPECT_EQ(frames, 1);
}

TEST_F(AgentIntentTest, IntentsAreSentOnRequestOnly) {
  begin(R"({"type":"hello","stock":true})");
  for (int ms = 0; ms < 40; ++ms) EXPECT_TRUE(step(0).empty());
}

TEST_F(AgentIntentTest, TheToolOfAMutedParticipantIsNotSent) {
  begin(R"({"type":"hello","intent":true})");
  ASSERT_TRUE(session->people().set_muted(bob, true));
  for (int ms = 0; ms < 40; ++ms) EXPECT_TRUE(step(0).empty());
}

TEST_F(AgentIntentTest, ARejectedMotionDoesNotCut) {
  begin(R"({"type":"hello","intent":true})");
  step(0);
  int frames = 0;
  for (int ms = 0; ms < 40; ++ms) {
    // Back and forth at 10 m/s.
    for (const wire::Intents& sent : step(ms % 2 == 0 ? 0 : 10)) {
      EXPECT_EQ(sent.tools[0].status, 0U);
      ++frames;
    }
  }
  EXPECT_GE(frames, 3);
}

}  // namespace
}  // namespace kerf::net::agent_intent_test
