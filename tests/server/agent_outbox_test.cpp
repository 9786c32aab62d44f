// SPDX-License-Identifier: Apache-2.0
#include "server/conversation/agent_outbox.h"

#include "tests/support/test.h"

namespace kerf::net::agent_outbox_test {
namespace {

using Kind = OutFrame::Kind;

wire::FrameStamp stamp(std::uint64_t sequence) { return {1, sequence, 0}; }

TEST(AgentOutbox, ResultsAreSentFirstAndStockLast) {
  AgentOutbox box;
  box.put_stock(stamp(1), {});
  EXPECT_TRUE(box.has_stock());
  EXPECT_TRUE(box.put_text("{}"));
  box.put_pong(stamp(1), {1, 2});
  box.put_felt(stamp(1), {});
  box.put_result(stamp(1), {}, {});
  OutFrame frame;
  for (const Kind kind : {Kind::kResult, Kind::kFelt, Kind::kText, Kind::kPong, Kind::kStock}) {
    ASSERT_TRUE(box.take(frame));
    EXPECT_EQ(frame.kind, kind);
  }
  EXPECT_FALSE(box.has_stock());
  EXPECT_FALSE(box.take(frame));
}

TEST(AgentOutbox, NewerResultReplacesAnUnsentOne) {
  AgentOutbox box;
  OutFrame frame;
  const auto later = Clock::time_point(std::chrono::seconds(5));
  box.put_result(stamp(1), {.agent_sequence = 1}, {});
  box.put_result(stamp(2), {.agent_sequence = 2}, later);
  ASSERT_TRUE(box.take(frame));
  const auto message = test::value_of(wire::decode(frame.bytes));
  EXPECT_EQ(std::get<wire::Result>(message.body).agent_sequence, 2U);
  EXPECT_EQ(message.header.stamp.sequence, 2U);
  EXPECT_EQ(frame.arrived, later);
  EXPECT_FALSE(box.take(frame));
}

TEST(AgentOutbox, AFullControlQueueRejectsTextsAndDropsPongs) {
  AgentOutbox box;
  for (std::size_t n = 0; n < ControlQueue::kMax; ++n) EXPECT_TRUE(box.put_text("{}"));
  EXPECT_FALSE(box.put_text("{}"));
  box.put_pong(stamp(1), {1, 2});
  OutFrame frame;
  std::size_t left = 0;
  while (box.take(frame)) ++left;
  EXPECT_EQ(left, ControlQueue::kMax);
}

TEST(AgentOutbox, AfterCloseOnlyQueuedControlMessagesAreSent) {
  AgentOutbox box;
  box.put_result(stamp(1), {}, {});
  box.put_stock(stamp(1), {});
  EXPECT_TRUE(box.put_text("bye"));
  box.close();
  box.put_result(stamp(2), {}, {});
  EXPECT_TRUE(box.put_text("too late"));
  OutFrame frame;
  ASSERT_TRUE(box.take(frame));
  EXPECT_EQ(std::string(reinterpret_cast<const char*>(frame.bytes.data()), frame.bytes.size()),
            "bye");
  EXPECT_FALSE(box.take(frame));
}

}  // namespace
}  // namespace kerf::net::agent_outbox_test
