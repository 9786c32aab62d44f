// SPDX-License-Identifier: Apache-2.0
// Durability of samples, and agents that continue as the same participant.

#include "tests/server/conversation_fixture.h"
#include "tests/support/content_of.h"

namespace kerf::net::agent_resume_test {
namespace {

using Kind = OutFrame::Kind;

const wire::Result& result_of(const wire::Message& message) {
  return std::get<wire::Result>(message.body);
}

class AgentResumeTest : public ConversationTest {
 protected:
  /// Sends a hello; returns the welcome.
  nlohmann::json hello(AgentConversation& conversation, const std::string& token = {}) {
    nlohmann::json message = {{"type", "hello"}, {"tool", 1}, {"durable", true}};
    if (!token.empty()) message["resume"] = token;
    send_text(conversation, message.dump());
    const auto list = messages(conversation);
    return list.empty() ? nlohmann::json() : list.front();
  }
  wire::Result move(AgentConversation& conversation, const wire::MotionBatch& samples) {
    send(conversation, encoded(samples));
    for (const OutFrame& frame : drain(conversation)) {
      if (frame.kind == Kind::kResult) return result_of(*wire::decode(frame.bytes));
    }
    ADD_FAILURE() << "no result";
    return {};
  }
};

TEST_F(AgentResumeTest, TokenAndDurableSequenceAreSentOnRequestOnly) {
  const auto ada = agent();
  send_text(*ada, R"({"type":"hello","tool":1})");
  EXPECT_FALSE(messages(*ada).at(0).contains("resume"));
  ASSERT_TRUE(session->flush());
  send(*ada, encoded(batch(3)));
  send(*ada, encoded(wire::Ping{7}));
  for (const OutFrame& frame : drain(*ada)) {
    EXPECT_EQ(wire::decode(frame.bytes)->header.header_bytes, wire::kHeaderBytes);
  }
}

TEST_F(AgentResumeTest, ResultsAndPongsStateTheDurableSample) {
  const auto ada = agent();
  const auto welcome = hello(*ada);
  EXPECT_EQ(welcome.at("resume").at("token").get<std::string>().size(), 32U);
  EXPECT_EQ(welcome.at("resume").at("resumed"), false);
  EXPECT_EQ(welcome.at("resume").at("agent_sequence"), 0);
  const wire::Result first = move(*ada, batch(3));
  EXPECT_LE(first.durable_sequence, 3U);
  ASSERT_TRUE(session->flush());
  send(*ada, encoded(wire::Ping{7}));
  const auto frames = drain(*ada);
  ASSERT_EQ(frames.size(), 1U);
  EXPECT_EQ(std::get<wire::Pong>(wire::decode(frames[0].bytes)->body).durable_sequence, 3U);
  EXPECT_GE(move(*ada, batch(1)).durable_sequence, 3U);
}

TEST_F(AgentResumeTest, RequiredCopyDelaysDurability) {
  session->place_in(nullptr, true);
  const auto durable = [this](AgentConversation& conversation) {
    send(conversation, encoded(wire::Ping{7}));
    const auto frames = drain(conversation);
    return std::get<wire::Pong>(wire::decode(frames.at(0).bytes)->body).durable_sequence;
  };
  const auto ada = agent();
  hello(*ada);
  const std::uint64_t before = session->sequence();
  move(*ada, batch(3));
  ASSERT_TRUE(session->flush());
  EXPECT_EQ(durable(*ada), 0U);
  session->copy().set({before + 1, "NATS cannot be reached"});
  EXPECT_EQ(durable(*ada), 0U) << "a batch is durable as a whole";
  session->copy().set({session->sequence(), ""});
  EXPECT_EQ(durable(*ada), 3U);
}

TEST_F(AgentResumeTest, ResumingContinuesWithoutAGapOrASecondCut) {
  auto ada = agent();
  const std::string token = hello(*ada)["resume"]["token"];
  const wire::MotionBatch first = batch(4);
  move(*ada, first);
  const std::uint64_t before = session->sequence();
  ada->end();
  ada = agent();
  const auto welcome = hello(*ada, token);
  EXPECT_EQ(welcome.at("participant"), 1);
  EXPECT_EQ(welcome.at("resume").at("resumed"), true);
  EXPECT_EQ(welcome.at("resume").at("agent_sequence"), 4);
  EXPECT_EQ(welcome.at("resume").at("token"), token);
  EXPECT_EQ(move(*ada, first).agent_sequence, 4U);
  EXPECT_EQ(session->sequence(), before) << "known samples are not cut again";
  move(*ada, batch(1));
  EXPECT_EQ(session->sequence(), before + 1) << "the motion from the last known sample";
}

TEST_F(AgentResumeTest, FirstStockFrameStatesTheNewestKnownSample) {
  auto ada = agent();
  const std::string token = hello(*ada)["resume"]["token"];
  const wire::MotionBatch path = batch(4);
  move(*ada, path);
  ada->end();
  ada = agent();
  send_text(*ada, nlohmann::json{{"type", "hello"}, {"stock", true}, {"resume", token}}.dump());
  drain(*ada);
  send(*ada, encoded(path));
  // The replica cuts later samples again. All of these are in the stock unless they were undone.
  std::vector<std::uint64_t> times_us;
  for (const OutFrame& frame : drain(*ada)) {
    const auto message = wire::decode(frame.bytes);
    const auto* stock = message ? std::get_if<wire::StockPatch>(&message->body) : nullptr;
    if (stock != nullptr) times_us.push_back(stock->agent_time_us);
  }
  EXPECT_EQ(times_us, std::vector{path.samples[3].time_us});
}

TEST_F(AgentResumeTest, NewConnectionReplacesTheOldOne) {
  const auto old = agent(), ada = agent();
  const std::string token = hello(*old)["resume"]["token"];
  move(*old, batch(2));
  EXPECT_EQ(hello(*ada, token).at("participant"), 1);
  EXPECT_TRUE(old->finishing());
  EXPECT_EQ(messages(*old).at(0).at("type"), "bye");
  old->end();
  EXPECT_EQ(session->info().participants.size(), 1U) << "the participant stays";
  EXPECT_EQ(move(*ada, batch(1)).agent_sequence, 3U);
}

TEST_F(AgentResumeTest, UnknownOrMalformedTokenCreatesANewParticipant) {
  const auto ada = agent();
  hello(*ada);
  std::uint64_t participant = 1;
  for (const std::string token :
       {"0123456789abcdef0123456789abcdef", "", "short", "0123456789ABCDEF0123456789ABCDEF"}) {
    const auto other = agent();
    const auto welcome = hello(*other, token);
    EXPECT_EQ(welcome.at("participant"), ++participant);
    EXPECT_EQ(welcome.at("resume").at("resumed"), false);
    EXPECT_NE(welcome.at("resume").at("token"), token);
  }
  const auto plain = agent();
  send_text(*plain, R"({"type":"hello","resume":"0123456789abcdef0123456789abcdef"})");
  EXPECT_EQ(messages(*plain).at(0).at("resume").at("token").get<std::string>().size(), 32U)
      << "resume implies durable";
  const auto last = agent();
  send_text(*last, R"({"type":"hello","resume":5})");
  EXPECT_EQ(error_code(*last), "bad_message");
}

TEST_F(AgentResumeTest, TokensSurviveARestartAndAreStoredHashed) {
  auto ada = agent();
  const std::string token = hello(*ada)["resume"]["token"];
  move(*ada, batch(4));
  ASSERT_TRUE(session->flush());
  const auto file = session->journal_file();
  ada.reset();
  session.reset();
  restart();
  ASSERT_TRUE(registry->load_all().failures.empty());
  session = registry->find("block");
  for (const char* suffix : {"", "-wal"}) {
    const std::string bytes = test::content_of(file.string() + suffix);
    EXPECT_EQ(bytes.find(token), std::string::npos);
  }
  ada = agent();
  const auto welcome = hello(*ada, token);
  EXPECT_EQ(welcome.at("participant"), 1);
  EXPECT_EQ(welcome.at("resume").at("agent_sequence"), 4);
}

TEST_F(AgentResumeTest, FullSessionAdmitsResumingAgents) {
  std::vector<std::unique_ptr<AgentConversation>> agents;
  std::string token;
  for (std::size_t n = 0; n < limits.agents_max; ++n) {
    token = hello(*agents.emplace_back(agent()))["resume"]["token"];
  }
  const auto again = agent(), more = agent();
  EXPECT_EQ(hello(*again, token).at("participant"), limits.agents_max);
  EXPECT_EQ(hello(*more).at("code"), "busy");
}

}  // namespace
}  // namespace kerf::net::agent_resume_test
