// SPDX-License-Identifier: Apache-2.0
// Random valid and invalid texts, frames and datagrams in random order, for both conversations.
#include <random>

#include "tests/server/conversation_fixture.h"

namespace kerf::net::conversation_fuzz_test {
namespace {

using std::chrono::microseconds;
using Kind = OutFrame::Kind;

constexpr std::uint64_t kSeeds = 100;
constexpr int kSteps = 300;

constexpr const char* kTexts[] = {
    R"({"type":"hello","name":"Ada"})",
    R"({"type":"hello","name":"Ada","tool":2,"udp":true,"stock":true,"intent":true,"feel_of":1})",
    R"({"type":"hello","name":"Ada","stock":true,"returned":true})",
    R"({"type":"hello","tool":99})",
    R"({"type":"hello","color":"red"})",
    R"({"type":"hello","name":7})",
    R"({"type":"tool","tool":1})",
    R"({"type":"tool","tool":2})",
    R"({"type":"tool","tool":-1})",
    R"({"type":"tool"})",
    R"({"type":"look","eye_mm":[0,0,90],"error_rad":0.001})",
    R"({"type":"look","eye_mm":[0,0,1e9],"error_rad":0.001})",
    R"({"type":"look","eye_mm":"here"})",
    R"({"type":"seek","at":1,"rate":0.5})",
    R"({"type":"seek","at":"live"})",
    R"({"type":"seek","at":-1})",
    R"({"type":"stock"})",
    R"({"type":"bye"})",
    R"({"type":null})",
    R"([])",
    "",
    "{",
    "\xff\xfe",
};

class Fuzz {
 public:
  explicit Fuzz(std::uint64_t seed) : random_(seed) {}
  std::uint64_t below(std::uint64_t limit) { return random_() % limit; }
  bool chance(double share) {
    return std::uniform_real_distribution<double>(0, 1)(random_) < share;
  }
  double real(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  std::string text() {
    std::string text = kTexts[below(std::size(kTexts))];
    if (chance(0.2) && !text.empty()) text[below(text.size())] = static_cast<char>(below(256));
    return text;
  }
  /// Flips bits, truncates or extends a frame.
  void damage(Bytes& frame) {
    if (frame.empty()) return;
    switch (below(3)) {
      case 0:
        frame[below(frame.size())] ^= static_cast<std::byte>(1U << below(8));
        break;
      case 1:
        frame.resize(below(frame.size()));
        break;
      default:
        frame.resize(frame.size() + 1 + below(5000));
    }
  }

 private:
  std::mt19937_64 random_;
};

/// Counts the errors that a conversation reports and checks the promised rate.
class ErrorCount {
 public:
  explicit ErrorCount(Clock::time_point start) : start_(start) {}
  void add(const nlohmann::json& message, Clock::time_point now) {
    if (message.at("type") != "error" || message.at("fatal") == true) return;
    ++count_;
    const double seconds = std::chrono::duration<double>(now - start_).count();
    EXPECT_LE(count_, Conversation::kErrorsBurst + Conversation::kErrorsPerS * seconds);
  }

 private:
  int count_ = 0;
  Clock::time_point start_;
};

class ConversationFuzzTest : public ConversationTest {
 protected:
  /// Starts a new session for each seed.
  void begin(std::uint64_t seed) {
    if (seed > 0) restart();
    const auto created = registry->create("fuzz" + std::to_string(seed), kScene, SceneSource{});
    ASSERT_TRUE(created);
    session = *created;
    sequence = 0;
    udp_offers = 0;
  }

  /// Mostly consecutive samples; sometimes repeated, skipped or impossible ones.
  wire::MotionBatch random_batch(Fuzz& fuzz) {
    wire::MotionBatch batch;
    if (fuzz.chance(0.1)) sequence += fuzz.below(4);
    if (fuzz.chance(0.1)) sequence -= std::min<std::uint64_t>(sequence, fuzz.below(20));
    const auto count = 1 + fuzz.below(4);
    for (std::uint64_t n = 0; n < count; ++n) {
      wire::MotionSample sample = next(fuzz.real(-3, 3), fuzz.real(-3, 3), fuzz.real(-2, 5));
      if (fuzz.chance(0.05)) sample.tool_id = static_cast<std::uint32_t>(fuzz.below(4));
      if (fuzz.chance(0.05)) sample.tip_mm = {1e6, 0, 0};
      if (fuzz.chance(0.05)) sample.axis = {0, 0, -1};
      if (fuzz.chance(0.2)) sample.buttons = 0;
      batch.samples[batch.count++] = sample;
    }
    return batch;
  }
  Bytes random_frame(Fuzz& fuzz) {
    switch (fuzz.below(6)) {
      case 0:
        return encoded(wire::Ping{fuzz.below(1000)});
      case 1:
        return encoded(wire::Pong{1, 2});
      case 2:
        return encoded(wire::Ack{}, fuzz.below(6));
      case 3:
        return encoded(wire::Result{});
      case 4:
        return encoded(wire::ToolStates{});
      default: {
        Bytes unknown = encoded(wire::Ping{1});
        unknown[4] = std::byte{200};
        return unknown;
      }
    }
  }
};

/// One agent under random input, with a model of the samples that must have been applied.
class AgentRun {
 public:
  AgentRun(AgentConversation& agent, const Clock::time_point& now, const int& udp_offers)
      : agent_(agent), now_(now), udp_offers_(udp_offers), errors_(now) {}

  void text(std::string_view text) {
    agent_.receive(std::as_bytes(std::span(text)), true, now_);
    agent_.refresh();
  }
  void frame(const Bytes& frame) {
    note(frame, false);
    agent_.receive(frame, false, now_);
    agent_.refresh();
  }
  void datagram(const Bytes& frame) {
    const bool open = agent_.has_joined() && !agent_.finishing() && !agent_.broken();
    const auto before = applied_;
    note(frame, true);
    agent_.receive_datagram(frame, now_);
    int results = 0;
    while (const OutDatagram* out = agent_.take_datagram()) {
      const auto message = wire::decode(out->frame());
      ASSERT_TRUE(message);
      if (const auto* result = std::get_if<wire::Result>(&message->body)) {
        ++results;
        EXPECT_EQ(result->agent_sequence, applied_);
      }
    }
    EXPECT_LE(results, 1);
    EXPECT_TRUE(open || applied_ == before);
    if (applied_ != before) {
      EXPECT_EQ(results, 1) << "an applied sample is answered on its transport";
      answered_ = applied_;
    }
    agent_.refresh();
  }
  /// Reads all waiting frames.
  void read() {
    OutFrame out;
    while (agent_.take(out)) {
      EXPECT_FALSE(over_) << "nothing is sent after the last frame";
      agent_.sent(out);
      if (out.is_text()) {
        const auto message = nlohmann::json::parse(text_of(out));
        errors_.add(message, now_);
        continue;
      }
      const auto message = wire::decode(out.bytes);
      ASSERT_TRUE(message);
      const auto* result = std::get_if<wire::Result>(&message->body);
      if (result != nullptr) answered_ = std::max(answered_, result->agent_sequence);
    }
    over_ = agent_.finishing();
    if (!agent_.finishing() && !agent_.broken()) {
      EXPECT_EQ(answered_, applied_) << "the newest result answers the last applied sample";
    }
  }

 private:
  /// Follows which samples the protocol applies.
  void note(const Bytes& frame, bool udp) {
    const auto message = wire::decode(frame, wire::kMaxClientFrameBytes);
    if (!message || !agent_.has_joined() || agent_.finishing() || agent_.broken()) return;
    if (message->header.stamp.epoch != kEpoch) return;
    const auto* batch = std::get_if<wire::MotionBatch>(&message->body);
    if (batch == nullptr || (udp && udp_offers_ == 0)) return;
    const auto samples = batch->view();
    const bool gap = applied_ == 0 || samples.front().agent_sequence > applied_ + 1;
    if (udp && gap) return;
    applied_ = std::max(applied_, samples.back().agent_sequence);
  }

  AgentConversation& agent_;
  const Clock::time_point& now_;
  const int& udp_offers_;
  ErrorCount errors_;
  std::uint64_t applied_ = 0, answered_ = 0;
  bool over_ = false;
};

TEST_F(ConversationFuzzTest, AgentsMaySendAnything) {
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Fuzz fuzz(seed);
    begin(seed);
    const auto other = agent();
    const auto ada = agent();
    AgentRun run(*ada, now, udp_offers);
    const bool reads = fuzz.chance(0.9);
    if (fuzz.chance(0.8)) run.text(kTexts[1]);
    run.read();
    for (int step = 0; step < kSteps; ++step) {
      now += microseconds(fuzz.below(20'000));
      Bytes frame = fuzz.chance(0.6) ? encoded(random_batch(fuzz)) : random_frame(fuzz);
      if (fuzz.chance(0.1)) fuzz.damage(frame);
      switch (fuzz.below(8)) {
        case 0:
          run.text(fuzz.text());
          break;
        case 1:
        case 2:
        case 3:
          run.datagram(frame);
          break;
        default:
          run.frame(frame);
      }
      if (fuzz.chance(0.01)) send_text(*other, kTexts[0]);
      if (fuzz.chance(0.002)) ada->hello_expired();
      if (fuzz.chance(0.002)) session->close("closed by the test");
      if (reads && fuzz.chance(0.7)) run.read();
      if (HasFatalFailure() || HasNonfatalFailure()) return;
    }
    session->close("end");
    run.read();
    for (int n = 0; n < 5; ++n) run.frame(encoded(random_batch(fuzz)));
    run.text(kTexts[0]);
    run.read();
    EXPECT_TRUE(ada->finishing() || ada->broken());
    ada->end();
    ada->end();
  }
}

TEST_F(ConversationFuzzTest, ViewersMaySendAnything) {
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Fuzz fuzz(seed);
    begin(seed);
    const auto eve = viewer();
    ErrorCount errors(now);
    std::uint64_t mesh_sent = 0, mesh_read = 0;
    int looks = 0;
    bool over = false;
    const bool reads = fuzz.chance(0.9);
    const Clock::time_point start = now;
    const auto read = [&] {
      for (const OutFrame& frame : drain(*eve)) {
        EXPECT_FALSE(over) << "nothing is sent after the last frame";
        if (frame.is_text()) errors.add(nlohmann::json::parse(text_of(frame)), now);
        if (frame.kind == Kind::kMesh) ++mesh_read;
      }
      over = eve->finishing();
      if (!over && !eve->broken()) {
        EXPECT_EQ(mesh_read, mesh_sent);
      }
    };
    for (int step = 0; step < kSteps; ++step) {
      now += microseconds(fuzz.below(20'000));
      Bytes frame = fuzz.chance(0.2) ? encoded(random_batch(fuzz)) : random_frame(fuzz);
      if (fuzz.chance(0.1)) fuzz.damage(frame);
      if (fuzz.chance(0.5)) {
        send_text(*eve, fuzz.text());
      } else {
        send(*eve, frame);
      }
      while (const auto action = eve->take_action()) {
        if (const auto* request = std::get_if<JoinRequest>(&*action)) {
          eve->joined(session->join(*request), session->roster());
        } else {
          EXPECT_TRUE(eve->has_joined());
        }
        looks += std::holds_alternative<ViewerLook>(*action) ? 1 : 0;
      }
      if (eve->has_joined() && !eve->finishing() && fuzz.chance(0.1)) {
        eve->send_mesh({.sequence = ++mesh_sent, .glb = std::make_shared<const Bytes>(9)});
      }
      if (fuzz.chance(0.1)) eve->send_tools(std::make_shared<const Bytes>(9));
      if (fuzz.chance(0.1)) eve->send_state({.sequence = fuzz.below(9), .hash = fuzz.below(9)});
      if (fuzz.chance(0.02)) eve->reject_ack();
      if (fuzz.chance(0.002)) eve->hello_expired();
      if (fuzz.chance(0.002)) eve->close("closed by the test");
      if (reads && fuzz.chance(0.7)) read();
      if (HasFatalFailure() || HasNonfatalFailure()) return;
    }
    const double seconds = std::chrono::duration<double>(now - start).count();
    EXPECT_LE(looks, ViewerConversation::kLooksBurst + ViewerConversation::kLooksPerS * seconds);
    eve->close("end");
    read();
    send_text(*eve, kTexts[0]);
    EXPECT_FALSE(eve->has_action());
    read();
    EXPECT_TRUE(eve->finishing() || eve->broken());
  }
}

}  // namespace
}  // namespace kerf::net::conversation_fuzz_test
