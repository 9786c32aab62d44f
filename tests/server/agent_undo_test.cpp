// SPDX-License-Identifier: Apache-2.0
#include <future>
#include <nlohmann/json.hpp>

#include "server/conversation/agent_conversation.h"
#include "tests/server/undo_fixture.h"

namespace kerf::net::agent_undo_test {
namespace {

using nlohmann::json;

/// Agents that undo in a session whose long work runs on another thread.
class AgentUndo : public SessionUndo {
 protected:
  void SetUp() override {
    SessionUndo::SetUp();
    create();
    agent_ =
        std::make_unique<AgentConversation>(AgentConversation::Setup{.session = session_,
                                                                     .limits = limits_,
                                                                     .metrics = metrics_,
                                                                     .wake = [this] { ++wakes_; },
                                                                     .open_udp = {}});
    send(R"({"type":"hello","name":"Ada","tool":1})");
    id_ = read().at(0).at("participant");
  }
  void TearDown() override { agent_.reset(); }

  void send(std::string_view text) {
    agent_->receive(std::as_bytes(std::span(text)), true, Clock::now());
  }
  std::vector<json> read() {
    std::vector<json> list;
    for (OutFrame frame; agent_->take(frame); agent_->sent(frame)) {
      if (!frame.is_text()) continue;
      list.push_back(
          json::parse(reinterpret_cast<const char*>(frame.bytes.data()),
                      reinterpret_cast<const char*>(frame.bytes.data()) + frame.bytes.size()));
    }
    return list;
  }
  /// Does the long work on another thread, and the session's turns in the meantime.
  void work() {
    auto done = std::async(std::launch::async, [this] { workers_.run(); });
    while (done.wait_for(std::chrono::microseconds(200)) != std::future_status::ready) {
      executor_->run();
    }
    executor_->run();
  }
  json answer(std::string_view text) {
    send(text);
    work();
    const auto list = read();
    return list.size() == 1 ? list[0] : json(list);
  }

  Metrics metrics_;
  int wakes_ = 0;
  std::unique_ptr<AgentConversation> agent_;
  ParticipantId id_ = 0;
};

TEST_F(AgentUndo, UndoesAndRedoesOwnStrokesOneByOne) {
  const ParticipantId other = join("Bo");
  const std::uint64_t untouched = hash();
  const StrokeId first = stroke(id_, {-10, 0, -2}, {10, 0, -2});
  const std::uint64_t one = hash();
  const StrokeId second = stroke(id_, {0, -10, -2}, {0, 10, -2});
  const std::uint64_t both = hash();
  const json undone = answer(R"({"type":"undo"})");
  EXPECT_EQ(undone.at("type"), "stroke");
  EXPECT_EQ(undone.at("undone"), true);
  EXPECT_EQ(undone.at("stroke"), second);
  EXPECT_GT(undone.at("returned_mm3"), 1.0);
  EXPECT_GT(wakes_, 0);
  EXPECT_EQ(hash(), one);
  EXPECT_EQ(answer(R"({"type":"undo"})").at("stroke"), first);
  EXPECT_EQ(hash(), untouched);
  EXPECT_EQ(answer(R"({"type":"redo"})").at("stroke"), first);
  EXPECT_EQ(answer(R"({"type":"redo"})").at("stroke"), second);
  EXPECT_EQ(hash(), both);

  stroke(other, {-10, 8, -2}, {10, 8, -2});
  EXPECT_EQ(answer(R"({"type":"undo"})").at("stroke"), second) << "those of others stay";
  EXPECT_EQ(hash(), never_happened());
}

TEST_F(AgentUndo, IsAnsweredWhenTheChangeIsCopied) {
  session_->place_in(nullptr, true);
  const StrokeId cut = stroke(id_, {-10, 0, -2}, {10, 0, -2});
  send(R"({"type":"undo"})");
  work();
  EXPECT_EQ(hash(), never_happened()) << "the block does not wait";
  EXPECT_TRUE(read().empty());
  session_->copy().set({.record = session_->sequence() - 1, .fault = ""});
  executor_->run(true);
  EXPECT_TRUE(read().empty()) << "the cut is copied, its undo is not";
  session_->copy().set({.record = session_->sequence(), .fault = ""});
  executor_->run(true);
  const auto answers = read();
  ASSERT_EQ(answers.size(), 1U);
  EXPECT_EQ(answers[0].at("stroke"), cut);
  EXPECT_FALSE(answers[0].contains("pending"));
}

/// An agent with a replica, whose tool moves in the air.
class ReplicaOwner {
 public:
  ReplicaOwner(const std::shared_ptr<Session>& session, const SessionLimits& limits,
               Metrics& metrics, std::string_view hello)
      : agent_({.session = session,
                .limits = limits,
                .metrics = metrics,
                .now = [this] { return now_ += std::chrono::seconds(1); },
                .wake = [] {},
                .open_udp = {}}),
        epoch_(session->epoch()) {
    agent_.receive(std::as_bytes(std::span(hello)), true, now_);
  }
  /// Sends samples until no more stock frames arrive. Returns the frames.
  std::vector<wire::StockPatch> stock_frames() {
    std::vector<wire::StockPatch> all;
    for (bool more = true; more;) {
      more = false;
      wire::MotionBatch moves;
      wire::MotionSample& sample = moves.samples.at(moves.count++);
      sample.time_us = 1000 * (sample.agent_sequence = ++sent_);
      sample.tip_mm = {0, 0, 2};
      sample.tool_id = 1;
      receive(moves, sent_);
      for (OutFrame frame; agent_.take(frame); agent_.sent(frame)) {
        if (frame.kind != OutFrame::Kind::kStock) continue;
        const auto message = wire::decode(frame.bytes);
        all.push_back(std::get<wire::StockPatch>(message->body));
        receive(wire::Ack{}, message->header.stamp.sequence);
        more = true;
      }
    }
    return all;
  }

 private:
  template <typename Body>
  void receive(const Body& body, std::uint64_t sequence) {
    std::vector<std::byte> bytes;
    wire::append(bytes, {.epoch = epoch_, .sequence = sequence, .time_us = 0}, body);
    agent_.receive(bytes, false, now_);
    agent_.refresh();
  }
  Clock::time_point now_{std::chrono::seconds(1000)};
  AgentConversation agent_;
  std::uint32_t epoch_;
  std::uint64_t sent_ = 0;
};

TEST_F(AgentUndo, ReplicasThatSupportItAcceptReturnedTiles) {
  ReplicaOwner can(session_, limits_, metrics_, R"({"type":"hello","stock":true,"returned":true})");
  ReplicaOwner cannot(session_, limits_, metrics_, R"({"type":"hello","stock":true})");
  stroke(id_, {-10, 0, -2}, {10, 0, -2});
  for (ReplicaOwner* owner : {&can, &cannot}) {
    const auto first = owner->stock_frames();
    ASSERT_FALSE(first.empty());
    EXPECT_TRUE(first[0].reset);
  }
  EXPECT_EQ(answer(R"({"type":"undo"})").at("undone"), true);
  const auto back = can.stock_frames(), all = cannot.stock_frames();
  ASSERT_FALSE(back.empty());
  EXPECT_TRUE(back[0].returned && !back[0].reset);
  ASSERT_FALSE(all.empty());
  EXPECT_TRUE(all[0].reset && !all[0].returned);
}

TEST_F(AgentUndo, UndoesTheStrokeThatIsNewestAtTheRequest) {
  const StrokeId first = stroke(id_, {-10, 0, -2}, {10, 0, -2});
  send(R"({"type":"undo"})");
  const StrokeId second = stroke(id_, {0, -10, -2}, {0, 10, -2});
  work();
  EXPECT_EQ(read().at(0).at("stroke"), first) << "not one that began while the undo waited";
  EXPECT_EQ(hash(), never_happened());
  send(R"({"type":"redo"})");
  undo({second});
  work();
  EXPECT_EQ(read().at(0).at("stroke"), first) << "not one that was undone while the redo waited";
  send(R"({"type":"undo"})");
  undo({first});
  work();
  EXPECT_EQ(read().at(0).at("code"), "bad_message") << "another has undone it meanwhile";
  EXPECT_EQ(hash(), never_happened());
}

TEST_F(AgentUndo, GetsTheReasonOfAFailure) {
  const json none = answer(R"({"type":"undo"})");
  EXPECT_EQ(none.at("type"), "stroke");
  EXPECT_EQ(none.at("code"), "bad_message");
  EXPECT_EQ(answer(R"({"type":"redo"})").at("undone"), false);
  stroke(id_, {-10, 0, -2}, {10, 0, -2});
  send(R"({"type":"undo"})");
  send(R"({"type":"undo"})");
  const auto busy = read();
  ASSERT_EQ(busy.size(), 1U);
  EXPECT_EQ(busy[0].at("code"), "busy");
  work();
  ASSERT_EQ(read().size(), 1U);
}

TEST_F(AgentUndo, IsRejectedForMutedAgents) {
  const auto outcome = [&](std::string_view text) {
    send(text);
    work();
    for (const json& message : read()) {
      if (message.at("type") == "stroke") return message.value("code", "done");
    }
    return std::string("none");
  };
  stroke(id_, {-10, 0, -2}, {10, 0, -2});
  const std::uint64_t one = hash();
  EXPECT_EQ(outcome(R"({"type":"undo"})"), "done");
  const std::uint64_t none = hash();
  ASSERT_TRUE(session_->people().set_muted(id_, true));
  const auto records = session_->sequence();
  EXPECT_EQ(outcome(R"({"type":"redo"})"), "muted");
  EXPECT_EQ(hash(), none);
  EXPECT_EQ(session_->sequence(), records);
  ASSERT_TRUE(session_->people().set_muted(id_, false));
  EXPECT_EQ(outcome(R"({"type":"redo"})"), "done");
  ASSERT_TRUE(session_->people().set_muted(id_, true));
  EXPECT_EQ(outcome(R"({"type":"undo"})"), "muted");
  EXPECT_EQ(hash(), one);
}

TEST_F(AgentUndo, AgentMayLeaveBeforeItsUndoBegins) {
  stroke(id_, {-10, 0, -2}, {10, 0, -2});
  const std::uint64_t carved = hash();
  send(R"({"type":"undo"})");
  agent_.reset();
  work();
  EXPECT_EQ(hash(), carved) << "who has left has no right any more";
}

}  // namespace
}  // namespace kerf::net::agent_undo_test
