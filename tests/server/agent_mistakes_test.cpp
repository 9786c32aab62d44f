// SPDX-License-Identifier: Apache-2.0
// Invalid messages of an agent: each gets its error, and the session continues.
#include <cstring>
#include <functional>
#include <limits>
#include <utility>
#include <vector>

#include "tests/server/conversation_fixture.h"

namespace kerf::net::agent_mistakes_test {
namespace {

using std::chrono::seconds;

class AgentMistakes : public ConversationTest {
 protected:
  void SetUp() override {
    ConversationTest::SetUp();
    mallory = agent();
    ada = agent();
    join_agent(*mallory, R"({"type":"hello","name":"Mallory"})");
    join_agent(*ada);
  }
  /// Copies `bytes` with one field replaced.
  static Bytes with(Bytes bytes, std::size_t place, std::uint32_t value) {
    std::memcpy(bytes.data() + place, &value, sizeof value);
    return bytes;
  }
  static Bytes resized(Bytes bytes, std::size_t size) {
    bytes.resize(size);
    return bytes;
  }
  static Bytes moves(const std::vector<wire::MotionSample>& samples) {
    wire::MotionBatch batch;
    for (const auto& sample : samples) batch.samples.at(batch.count++) = sample;
    return encoded(batch);
  }
  wire::MotionSample turned(Vec3f axis) {
    wire::MotionSample sample = next(0, 0, 5);
    sample.axis = axis;
    return sample;
  }
  void expect_both_go_on() {
    for (const auto& peer : {mallory.get(), ada.get()}) {
      const std::uint64_t before = session->info().motions;
      send(*peer, moves({next(0, 0, -1), next(1, 0, -1), next(2, 0, -1.5)}));
      drain(*peer);
      EXPECT_GE(session->info().motions, before + 2);
    }
  }

  std::unique_ptr<AgentConversation> mallory, ada;
};

/// Offsets of fields in a frame: in its header, and the number of its samples.
constexpr std::size_t kMagicAt = 0, kTypeAt = 4, kPayloadAt = 8, kCountAt = 32;

TEST_F(AgentMistakes, EachInvalidFrameGetsItsErrorAndTheSessionContinues) {
  constexpr float kInfinite = std::numeric_limits<float>::infinity();
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const Bytes one = encoded(batch()), sixteen = encoded(batch(16));
  const auto payload = static_cast<std::uint32_t>(sixteen.size() - wire::kHeaderBytes);
  const auto of_unknown_tool = [&] {
    wire::MotionSample sample = next(0, 0, 5);
    sample.tool_id = 99;
    return moves({sample});
  };
  const auto at_one_time = [&] {
    const wire::MotionSample before = next(0, 0, 5);
    wire::MotionSample after = next(1, 0, 5);
    after.time_us = before.time_us;
    return moves({before, after});
  };
  // Create samples when they are sent: those with an earlier number are skipped.
  const std::pair<std::function<Bytes()>, const char*> rows[] = {
      {[&] { return Bytes(7, std::byte{'g'}); }, "bad_frame"},
      {[&] { return with(one, kMagicAt, 0x12345678); }, "bad_frame"},
      {[&] { return with(one, kPayloadAt, 64); }, "bad_frame"},
      {[&] { return Bytes(5000); }, "too_large"},
      {[&] { return with(with(resized(one, kCountAt + 8), kPayloadAt, 8), kCountAt, 0); },
       "bad_frame"},
      {[&] {
         const Bytes longer = resized(sixteen, sixteen.size() + 64);
         return with(with(longer, kPayloadAt, payload + 64), kCountAt, 17);
       },
       "bad_frame"},
      {[&] { return moves({next(kNan, 0, 0)}); }, "bad_pose"},
      {[&] { return moves({turned({0, 0, kInfinite})}); }, "bad_pose"},
      {[&] { return moves({turned({0, 0, 2})}); }, "bad_pose"},
      {[&] { return moves({next(1e9, 0, 0)}); }, "bad_pose"},
      {of_unknown_tool, "unknown_tool"},
      {[&] { return moves({next(0, 0, 5), next(0, 0, -15)}); }, "too_fast"},
      {[&] { return moves({turned({0, 0, 1}), turned({0, 0, -1})}); }, "turn_too_large"},
      {at_one_time, "bad_message"},
      {[&] { return encoded(wire::Ack{}); }, "bad_message"},
      {[&] { return encoded(wire::Result{}); }, "bad_message"},
  };
  for (const auto& [frame, code] : rows) {
    SCOPED_TRACE(code);
    now += seconds(1);  // below the limit of reported errors
    send(*mallory, frame());
    const auto list = messages(*mallory);
    ASSERT_FALSE(list.empty());
    EXPECT_EQ(list.back().at("code"), code);
    EXPECT_EQ(list.back().at("fatal"), false);
    EXPECT_FALSE(list.back().at("reason").get<std::string>().empty());
    expect_both_go_on();
  }
}

TEST_F(AgentMistakes, EachInvalidTextGetsItsError) {
  const std::pair<const char*, const char*> rows[] = {
      {"{", "bad_json"},
      {"", "bad_json"},
      {"[1,2]", "bad_json"},
      {R"("hello")", "bad_json"},
      {R"({"type":"tool")", "bad_json"},
      {"\xFF\xFE", "bad_json"},
      {R"({"type":"dance"})", "bad_message"},
      {R"({"type":"tool"})", "bad_message"},
      {R"({"type":"tool","tool":"one"})", "bad_message"},
      {R"({"type":"tool","tool":-1})", "bad_message"},
      {R"({"type":7})", "bad_message"},
      {"{}", "bad_message"},
      {R"({"type":"hello","name":"again"})", "bad_message"},
      {R"({"type":"look","eye_mm":[0,0,9],"error_rad":0})", "bad_message"},
      {R"({"type":"tool","tool":77})", "unknown_tool"},
  };
  for (const auto& [text, code] : rows) {
    now += seconds(1);
    send_text(*mallory, text);
    EXPECT_EQ(error_code(*mallory), code) << text;
  }
  expect_both_go_on();
}

TEST_F(AgentMistakes, UnknownFrameTypesAreSkipped) {
  Bytes unknown = encoded(wire::Ping{});
  unknown[kTypeAt] = std::byte{99};
  send(*mallory, unknown);
  EXPECT_TRUE(drain(*mallory).empty());
  expect_both_go_on();
}

TEST_F(AgentMistakes, RejectedHelloMayBeRepeated) {
  const auto eve = agent();
  send_text(*eve, R"({"type":"hello","name":"Eve","tool":42})");
  EXPECT_EQ(error_code(*eve), "unknown_tool");
  send_text(*eve, R"({"type":"hello","name":"Eve","color":"red"})");
  EXPECT_EQ(error_code(*eve), "bad_message");
  join_agent(*eve, R"({"type":"hello","name":"Eve","tool":2})");
}

class AgentFlood : public ConversationTest {
 protected:
  void SetUp() override {
    SessionTest::SetUp();  // with the limits of every session
    session = start();
  }
};

TEST_F(AgentFlood, SampleFloodIsRejectedWithoutDelayingOtherAgents) {
  const auto mallory = agent(), ada = agent();
  join_agent(*mallory, R"({"type":"hello","name":"Mallory"})");
  join_agent(*ada);
  std::string code;
  for (int n = 0; n < 120 && code.empty(); ++n) {
    send(*mallory, encoded(batch(16)));
    for (const auto& message : messages(*mallory)) {
      if (message.at("type") == "error") code = message.at("code");
    }
  }
  EXPECT_EQ(code, "too_fast");
  const std::uint64_t motions = session->info().motions;
  send(*ada, encoded(batch(3)));
  EXPECT_EQ(session->info().motions, motions + 2);
}

class AgentCuts : public ConversationTest {
 protected:
  void SetUp() override {
    ConversationTest::SetUp();
    ada = agent();
    join_agent(*ada);
  }
  wire::Result answer(wire::MotionSample sample, bool cuts = true) {
    if (!cuts) sample.buttons = 0;
    wire::MotionBatch batch;
    batch.samples[batch.count++] = sample;
    send(*ada, encoded(batch));
    for (const OutFrame& frame : drain(*ada)) {
      if (frame.kind != OutFrame::Kind::kResult) continue;
      const auto message = wire::decode(frame.bytes);
      if (message) return std::get<wire::Result>(message->body);
    }
    ADD_FAILURE() << "no result";
    return {};
  }
  std::unique_ptr<AgentConversation> ada;
};

TEST_F(AgentCuts, ResultsReportForceAndRemovedVolume) {
  double removed = 0, force = 0;
  wire::Result result;
  for (int n = 0; n < 300; ++n) {
    result = answer(next(-30 + 0.1 * n, 0, -2));
    removed += static_cast<double>(result.removed_mm3);
    force = std::max(force, -static_cast<double>(result.force_n.x));
  }
  EXPECT_GT(removed, 50);
  EXPECT_NEAR(session->info().removed_mm3, removed, removed * 1e-5);
  EXPECT_GT(force, 0.5);
  EXPECT_GT(result.engaged_area_mm2, 1);
  EXPECT_TRUE(result.status & wire::kStatusCutting);
}

TEST_F(AgentCuts, MovesThroughTheAirCutNothing) {
  for (int n = 0; n < 10; ++n) answer(next(-10 + n, 0, -2), false);
  EXPECT_EQ(session->info().motions, 0U);
  EXPECT_EQ(session->info().removed_mm3, 0);
}

TEST_F(AgentCuts, GapBetweenSamplesIsCutAlongItsChord) {
  answer(next(-10, 0, -2));
  sequence += 50;  // fifty samples were lost
  EXPECT_GT(answer(next(10, 0, -2)).removed_mm3, 100);
  const double before = session->info().removed_mm3;
  answer(next(0, 0, -2));
  EXPECT_EQ(session->info().removed_mm3, before) << "the chord is cut already";
}

TEST_F(AgentCuts, RepeatedSamplesAreSkipped) {
  answer(next(0, 0, -1));
  const wire::MotionSample sample = next(1, 0, -1);
  const wire::Result first = answer(sample), again = answer(sample);
  EXPECT_GT(first.removed_mm3, 0);
  EXPECT_EQ(again.removed_mm3, 0);
  EXPECT_EQ(again.motions_applied, first.motions_applied);
}

}  // namespace
}  // namespace kerf::net::agent_mistakes_test
