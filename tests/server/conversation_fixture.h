// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <memory>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "server/conversation/agent_conversation.h"
#include "server/conversation/viewer_conversation.h"
#include "tests/server/session_fixture.h"

namespace kerf::net {

using Bytes = std::vector<std::byte>;

/// Epoch of a new session: its journal was created and opened.
inline constexpr std::uint32_t kEpoch = 2;

template <typename Body>
Bytes encoded(const Body& body, std::uint64_t sequence = 1, std::uint32_t epoch = kEpoch) {
  Bytes bytes;
  wire::append(bytes, {.epoch = epoch, .sequence = sequence, .time_us = 0}, body);
  return bytes;
}

inline std::string text_of(const OutFrame& frame) {
  return {reinterpret_cast<const char*>(frame.bytes.data()), frame.bytes.size()};
}

/// A session, a simulated clock and the conversations of its peers.
class ConversationTest : public SessionTest {
 protected:
  void SetUp() override {
    // The session limits rates by the real clock, which is slower than the simulated one.
    limits.samples_per_s = limits.samples_burst = 1e12;
    SessionTest::SetUp();
    session = start();
  }

  std::unique_ptr<AgentConversation> agent() {
    return std::make_unique<AgentConversation>(
        AgentConversation::Setup{.session = session,
                                 .limits = limits,
                                 .metrics = metrics,
                                 .now = [this] { return now; },
                                 .wake = [this] { ++wakes; },
                                 .open_udp =
                                     [this] {
                                       ++udp_offers;
                                       return offer;
                                     }});
  }
  std::unique_ptr<ViewerConversation> viewer(std::uint32_t budget_max = 0) {
    return std::make_unique<ViewerConversation>(
        session, metrics, [this] { return now; }, [this] { ++wakes; }, Caller::local(), budget_max);
  }

  void send_text(Conversation& conversation, std::string_view text) {
    conversation.receive(std::as_bytes(std::span(text)), true, now);
  }
  void send(Conversation& conversation, const Bytes& frame) {
    conversation.receive(frame, false, now);
    conversation.refresh();
  }
  void join_agent(AgentConversation& conversation,
                  std::string_view hello = R"({"type":"hello","name":"Ada","tool":1})") {
    send_text(conversation, hello);
    ASSERT_TRUE(conversation.has_joined());
    drain(conversation);
  }
  /// Handles a hello like the owner of a viewer.
  void perform_join(ViewerConversation& conversation) {
    const auto action = conversation.take_action();
    ASSERT_TRUE(action);
    const auto* request = std::get_if<JoinRequest>(&*action);
    ASSERT_NE(request, nullptr);
    const auto joined = session->join(*request);
    conversation.joined(joined, session->roster());
  }
  void join_viewer(ViewerConversation& conversation,
                   std::string_view hello = R"({"type":"hello","name":"Eve"})") {
    send_text(conversation, hello);
    perform_join(conversation);
    ASSERT_TRUE(conversation.has_joined());
    drain(conversation);
  }

  /// Takes all waiting frames, like a peer that reads at once.
  std::vector<OutFrame> drain(Conversation& conversation) {
    std::vector<OutFrame> frames;
    OutFrame frame;
    while (conversation.take(frame)) {
      conversation.sent(frame);
      frames.push_back(frame);
    }
    return frames;
  }
  /// Takes the JSON messages among the waiting frames.
  std::vector<nlohmann::json> messages(Conversation& conversation) {
    std::vector<nlohmann::json> list;
    for (const OutFrame& frame : drain(conversation)) {
      if (frame.is_text()) list.push_back(nlohmann::json::parse(text_of(frame)));
    }
    return list;
  }
  /// Returns the code of the only waiting message, which must be an error.
  std::string error_code(Conversation& conversation) {
    const auto list = messages(conversation);
    if (list.size() != 1 || list[0].at("type") != "error") return "not one error message";
    return list[0].at("code");
  }
  wire::MotionBatch batch(int count = 1) {
    wire::MotionBatch batch;
    for (int n = 0; n < count; ++n) {
      batch.samples.at(batch.count++) = next(0.01 * double(sequence), 0, -1);
    }
    return batch;
  }

  Metrics metrics;
  Clock::time_point now{std::chrono::seconds(1000)};
  std::shared_ptr<Session> session;
  std::optional<datagram::Offer> offer = datagram::Offer{.port = 4000, .connection = 7};
  int wakes = 0, udp_offers = 0;
};

}  // namespace kerf::net
