// SPDX-License-Identifier: Apache-2.0
// Which frames use which transport, with a simulated clock and network.
#include "haptic_agent/link/control_message.h"
#include "haptic_agent/link/traffic.h"
#include "server/datagram/layout.h"
#include "server/wire/codec.h"
#include "tests/support/test.h"

namespace kerf::agent::traffic_datagrams_test {
namespace {

constexpr std::uint64_t kRttUs = 10'000;

class TrafficDatagrams : public ::testing::Test {
 protected:
  using Numbers = std::vector<std::uint64_t>;

  void SetUp() override { traffic.begin(1, 1, now_us, true); }

  void push(int count, std::uint32_t tool = 1) {
    for (int i = 0; i < count; ++i) {
      // A zigzag, so that no sample may be merged.
      const double z = ++pushed % 2 == 0 ? 1 : 0;
      ASSERT_TRUE(ring.push({.time_us = now_us,
                             .tip_mm = {0, 0, z},
                             .tool_id = tool,
                             .buttons = wire::kButtonCutting}));
    }
    traffic.collect();
  }

  static Numbers numbers(const std::optional<wire::MotionBatch>& batch) {
    Numbers found;
    if (!batch) return found;
    for (const auto& sample : batch->view()) found.push_back(sample.agent_sequence);
    return found;
  }

  /// Returns the next motion over a transport. Counts pings.
  std::optional<wire::MotionBatch> next(bool udp) {
    std::array<std::byte, datagram::kMaxFrameBytes> frame;
    while (const std::size_t bytes =
               udp ? traffic.fill_datagram(now_us, frame) : traffic.fill(now_us, frame)) {
      const auto message = wire::decode(std::span(frame).first(bytes));
      if (const auto* batch = std::get_if<wire::MotionBatch>(&message->body)) return *batch;
      ++pings;
    }
    return std::nullopt;
  }
  Numbers over_udp() { return numbers(next(true)); }
  Numbers over_web_socket() { return numbers(next(false)); }
  /// Returns all due motions over UDP, in order.
  std::vector<Numbers> all_over_udp() {
    std::vector<Numbers> all;
    for (Numbers one = over_udp(); !one.empty(); one = over_udp()) all.push_back(one);
    return all;
  }

  template <typename Body>
  void take(const Body& body, bool udp) {
    std::vector<std::byte> frame;
    wire::append(frame, {.epoch = 1, .sequence = ++sequence, .time_us = 1}, body);
    ASSERT_FALSE(udp ? traffic.take_datagram(frame, now_us) : traffic.take_frame(frame, now_us));
  }
  void answer(std::uint64_t number, bool udp, std::uint32_t status = 0, float fz = 0) {
    take(wire::Result{.agent_sequence = number, .force_n = {0, 0, fz}, .status = status}, udp);
  }
  void pong() { take(wire::Pong{.ping_time_us = now_us - kRttUs, .time_us = 1}, true); }

  /// Sends samples 1 to 3 over the WebSocket, answers them, and switches to UDP.
  void switch_to_udp() {
    push(3);
    ASSERT_EQ(over_web_socket(), (Numbers{1, 2, 3}));
    answer(3, false);
    pong();
    next(true);
    ASSERT_TRUE(traffic.report().udp.carries);
  }

  SampleRing ring;
  LatestValue<ServerWrench> wrenches;
  Traffic traffic{ring, wrenches};
  std::uint64_t now_us = 1'000'000, pushed = 0, sequence = 0;
  int pings = 0;
};

TEST_F(TrafficDatagrams, UsesTheWebSocketUntilUdpIsConfirmed) {
  push(3);
  EXPECT_TRUE(over_udp().empty());
  EXPECT_EQ(pings, 1) << "a probe";
  EXPECT_EQ(over_web_socket(), (Numbers{1, 2, 3}));
  answer(3, false);
  push(1);
  EXPECT_TRUE(over_udp().empty());
  EXPECT_EQ(over_web_socket(), (Numbers{4}));
  pong();
  push(1);
  EXPECT_EQ(over_udp(), (Numbers{4, 5})) << "with the unanswered sample";
  push(1);
  EXPECT_TRUE(over_web_socket().empty());
  EXPECT_EQ(over_udp(), (Numbers{4, 5, 6}));
}

TEST_F(TrafficDatagrams, UsesTheWebSocketUntilTheFirstAnswer) {
  pong();
  push(3);
  EXPECT_TRUE(over_udp().empty());
  EXPECT_EQ(over_web_socket(), (Numbers{1, 2, 3}));
  push(1);
  EXPECT_TRUE(over_udp().empty()) << "the server may not have the first pose yet";
  answer(1, false);
  EXPECT_EQ(over_udp(), (Numbers{2, 3, 4}));
}

TEST_F(TrafficDatagrams, WithoutAnOfferUdpIsNotUsed) {
  traffic.begin(1, 1, now_us, false);
  push(3);
  pong();
  EXPECT_TRUE(over_udp().empty());
  EXPECT_EQ(pings, 0);
  EXPECT_EQ(over_web_socket(), (Numbers{1, 2, 3}));
}

TEST_F(TrafficDatagrams, EachDatagramRepeatsUnansweredSamplesUpToItsSize) {
  switch_to_udp();
  Numbers last;
  for (int i = 0; i < 40; ++i) {
    push(1);
    last = over_udp();
  }
  ASSERT_EQ(last.size(), wire::kMaxSamplesPerMotion);
  EXPECT_EQ(last.front(), 43U - 15U);
  EXPECT_EQ(last.back(), 43U);
  answer(41, true);
  push(1);
  EXPECT_EQ(over_udp(), (Numbers{42, 43, 44}));
  EXPECT_EQ(traffic.report().samples_sent, 44U);
  EXPECT_EQ(traffic.report().resent, 0U);
  EXPECT_GT(traffic.report().udp.repeated, 15U * 20U);
}

TEST_F(TrafficDatagrams, BacklogIsSentTwice) {
  switch_to_udp();
  push(20);
  const auto all = all_over_udp();
  ASSERT_EQ(all.size(), 3U);
  EXPECT_EQ(all[0].front(), 4U);
  EXPECT_EQ(all[0].back(), 11U);
  EXPECT_EQ(all[1].front(), 4U);
  EXPECT_EQ(all[1].back(), 19U);
  EXPECT_EQ(all[2].back(), 23U);
}

TEST_F(TrafficDatagrams, GapCausesAResendOfUnansweredSamples) {
  switch_to_udp();
  now_us += 100'000;
  for (int i = 0; i < 30; ++i) {
    push(1);
    over_udp();
  }
  now_us += 1000;
  answer(5, true);
  answer(5, true, wire::kStatusGap);
  const auto again = all_over_udp();
  ASSERT_FALSE(again.empty());
  EXPECT_EQ(again.front().front(), 6U);
  EXPECT_EQ(again.back().back(), 33U);
  // Datagrams in flight behind the lost ones cause the same answer. Only the first counts.
  answer(5, true, wire::kStatusGap);
  EXPECT_TRUE(over_udp().empty());
  EXPECT_EQ(traffic.report().udp.gaps, 2U);
  EXPECT_EQ(traffic.report().unanswered, 28U);
}

TEST_F(TrafficDatagrams, UnansweredSamplesAreResentWithBackoff) {
  switch_to_udp();
  push(1);
  EXPECT_EQ(over_udp(), (Numbers{4}));
  std::vector<std::uint64_t> at_us;
  const std::uint64_t start_us = now_us;
  for (int i = 0; i < 280; ++i) {
    now_us += 1000;
    if (!over_udp().empty()) at_us.push_back(now_us - start_us);
  }
  ASSERT_GE(at_us.size(), 2U);
  EXPECT_LE(at_us.size(), 5U);
  EXPECT_GT(at_us[1] - at_us[0], at_us[0]);
}

TEST_F(TrafficDatagrams, SilenceSwitchesBackToTheWebSocket) {
  switch_to_udp();
  push(2);
  over_udp();
  now_us += TransportSwitch::kSilenceUs + kRttUs;
  over_udp();
  EXPECT_TRUE(over_web_socket().empty()) << "not yet";
  now_us += 1;
  EXPECT_EQ(over_web_socket(), (Numbers{4, 5}));
  EXPECT_FALSE(traffic.report().udp.carries);
  EXPECT_EQ(traffic.report().udp.fell_back, 1U);
  EXPECT_EQ(traffic.take_notice(), "UDP has gone silent, back on the WebSocket");
  EXPECT_EQ(traffic.take_notice(), "");
  // UDP is probed again after a pause, and used again after a new answer.
  answer(5, false);
  pong();
  push(1);
  EXPECT_TRUE(over_udp().empty()) << "answers to old probes do not count";
  EXPECT_EQ(over_web_socket(), (Numbers{6}));
  answer(6, false);
  now_us += TransportSwitch::kFirstPauseUs;
  next(true);
  pong();
  push(1);
  EXPECT_EQ(over_udp(), (Numbers{7}));
}

TEST_F(TrafficDatagrams, SilenceWithoutUnansweredSamplesIsNoFailure) {
  switch_to_udp();
  now_us += 10 * TransportSwitch::kSilenceUs;
  push(1);
  EXPECT_EQ(over_udp(), (Numbers{4}));
}

TEST_F(TrafficDatagrams, BlockedPortIsProbedRarely) {
  push(1);
  EXPECT_EQ(over_web_socket(), (Numbers{1}));
  answer(1, false);
  for (int i = 0; i < 600; ++i) {
    now_us += 100'000;
    next(true);
  }
  EXPECT_LT(pings, 80) << "rarely, in a minute";
  EXPECT_GT(pings, TransportSwitch::kProbes);
  EXPECT_EQ(traffic.take_notice(), "no answer over UDP, staying on the WebSocket");
  EXPECT_EQ(traffic.take_notice(), "");
}

TEST_F(TrafficDatagrams, ToolChangeIsSentBetweenTheSamples) {
  switch_to_udp();
  push(2);
  over_udp();
  push(2, 2);
  EXPECT_TRUE(over_udp().empty()) << "samples of the new tool wait for the tool message";
  EXPECT_EQ(traffic.take_control(now_us), "") << "the old tool's samples precede it";
  EXPECT_EQ(over_web_socket(), (Numbers{4, 5}));
  EXPECT_EQ(traffic.take_control(now_us), tool_text(2));
  EXPECT_EQ(over_web_socket(), (Numbers{6, 7}));
  answer(5, true);
  push(1, 2);
  EXPECT_TRUE(over_udp().empty()) << "the tool message may still be in flight";
  EXPECT_EQ(over_web_socket(), (Numbers{8}));
  answer(6, false);
  push(1, 2);
  EXPECT_EQ(over_udp(), (Numbers{7, 8, 9}));
}

TEST_F(TrafficDatagrams, ToolChangeIsSentAtOnceIfEverythingIsAnswered) {
  switch_to_udp();
  push(2, 2);
  EXPECT_TRUE(over_udp().empty());
  EXPECT_EQ(traffic.take_control(now_us), tool_text(2));
  EXPECT_EQ(over_web_socket(), (Numbers{4, 5}));
  EXPECT_EQ(traffic.take_control(now_us), "");
}

TEST_F(TrafficDatagrams, UndoPressIsOneRequestAfterItsSamples) {
  const auto press = [&](std::uint32_t buttons) {
    ASSERT_TRUE(ring.push({.time_us = now_us, .tool_id = 1, .buttons = buttons}));
    traffic.collect();
  };
  for (int n = 0; n < 3; ++n) press(wire::kButtonCutting | kButtonUndo);
  EXPECT_EQ(traffic.take_control(now_us), "") << "the samples before it precede it";
  const auto sent = test::value_of(next(false));
  for (const auto& sample : sent.view()) EXPECT_EQ(sample.buttons, wire::kButtonCutting);
  EXPECT_EQ(traffic.take_control(now_us), change_text(true));
  EXPECT_EQ(traffic.take_control(now_us), "") << "held, not pressed again";
  press(0);
  press(kButtonRedo);
  press(kButtonUndo);
  while (next(false)) continue;
  EXPECT_EQ(traffic.take_control(now_us), change_text(false));
  EXPECT_EQ(traffic.take_control(now_us), change_text(true));
  press(kButtonRedo);
  traffic.begin(1, 1, now_us, true);
  while (next(false)) continue;
  EXPECT_EQ(traffic.take_control(now_us), "") << "given up with the connection";
}

TEST_F(TrafficDatagrams, RequestKeepsItsOrderWithDatagrams) {
  switch_to_udp();
  push(2);
  EXPECT_EQ(over_udp(), (Numbers{4, 5}));
  traffic.ask(true);
  push(1);
  EXPECT_EQ(traffic.take_control(now_us), "") << "the datagram may still be in flight";
  EXPECT_TRUE(over_udp().empty()) << "or the request would wait for this sample too";
  answer(5, true);
  EXPECT_TRUE(over_udp().empty());
  EXPECT_EQ(traffic.take_control(now_us), "");
  EXPECT_EQ(over_web_socket(), (Numbers{6}));
  EXPECT_EQ(traffic.take_control(now_us), change_text(true));
  answer(6, false);
  push(1);
  EXPECT_TRUE(over_udp().empty()) << "the request may still be in flight";
  EXPECT_EQ(over_web_socket(), (Numbers{7}));
  answer(7, false);
  push(1);
  EXPECT_EQ(over_udp(), (Numbers{8}));
}

TEST_F(TrafficDatagrams, ARequestIsSentAfterItsDatagramsWereLost) {
  switch_to_udp();
  push(2);
  over_udp();
  traffic.ask(false);
  now_us += TransportSwitch::kSilenceUs + kRttUs + 1;
  EXPECT_EQ(over_web_socket(), (Numbers{4, 5}));
  EXPECT_EQ(traffic.take_control(now_us), change_text(false));
}

TEST_F(TrafficDatagrams, UserIsNotifiedOfTheResultOfAnUndo) {
  std::string notice;
  EXPECT_FALSE(traffic.take_text(R"({"type":"stroke","undone":true,"stroke":12})", notice));
  EXPECT_EQ(notice, "stroke 12 undone");
  EXPECT_FALSE(traffic.take_text(R"({"type":"stroke","undone":false,"stroke":7})", notice));
  EXPECT_EQ(notice, "stroke 7 redone");
  EXPECT_FALSE(traffic.take_text(
      R"({"type":"stroke","undone":true,"code":"busy","reason":"not yet"})", notice));
  EXPECT_EQ(notice, "cannot undo: not yet");
}

TEST_F(TrafficDatagrams, OldAnswersAreIgnored) {
  switch_to_udp();
  push(5);
  over_udp();
  answer(7, true, 0, 2.0F);
  answer(6, true, 0, 5.0F);
  answer(7, true, wire::kStatusGap, 6.0F);
  ServerWrench wrench;
  ASSERT_TRUE(wrenches.read(wrench));
  EXPECT_EQ(wrench.wrench.force_n.z, 2.0);
  EXPECT_EQ(traffic.report().old_results, 2U);
  EXPECT_EQ(traffic.report().results, 2U);
}

TEST_F(TrafficDatagrams, FollowedWrenchNeverGoesBackInTime) {
  switch_to_udp();
  wire::ToolState other{.force_n = {1, 0, 0}};
  std::vector<std::byte> early;
  wire::append(early, {.epoch = 1, .sequence = 50, .time_us = 1}, wire::ToolStates{{other}});
  other.force_n = {2, 0, 0};
  std::vector<std::byte> late;
  wire::append(late, {.epoch = 1, .sequence = 51, .time_us = 1}, wire::ToolStates{{other}});
  EXPECT_FALSE(traffic.take_datagram(late, now_us));
  EXPECT_FALSE(traffic.take_datagram(early, now_us));
  push(1);
  over_udp();
  answer(4, true);
  ServerWrench wrench;
  ASSERT_TRUE(wrenches.read(wrench));
  EXPECT_EQ(wrench.felt.force_n.x, 2.0);
}

TEST_F(TrafficDatagrams, NewConnectionStartsOnTheWebSocket) {
  switch_to_udp();
  push(2);
  over_udp();
  traffic.begin(1, 1, now_us, true);
  push(1);
  EXPECT_TRUE(over_udp().empty());
  EXPECT_EQ(over_web_socket(), (Numbers{3, 4, 5, 6})) << "preceded by the last answered sample";
}

}  // namespace
}  // namespace kerf::agent::traffic_datagrams_test
