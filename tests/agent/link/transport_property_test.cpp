// SPDX-License-Identifier: Apache-2.0
// Property: whatever the network does, each sample is applied once and in order, and each motion
// starts at the preceding sample. Runs the agent's Traffic and the server's SampleGate on simulated
// networks and a simulated clock.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <map>
#include <nlohmann/json.hpp>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "haptic_agent/link/traffic.h"
#include "server/conversation/sample_gate.h"
#include "server/datagram/layout.h"
#include "server/wire/codec.h"

namespace kerf::agent {
namespace {

using Frame = std::vector<std::byte>;

constexpr std::uint64_t kStepUs = 1000;

/// Faults of a simulated network.
struct NetworkFaults {
  double loss = 0, duplication = 0;
  std::uint64_t udp_delay_us = 0, udp_jitter_us = 0, ws_delay_us = 0;
  double ws_stall = 0;    ///< probability per message of a delay of 250 ms
  double black_hole = 0;  ///< probability per ms that an outage of UDP begins
};

/// Messages in flight in one direction, ordered by arrival time.
template <typename Message>
class Channel {
 public:
  void put(std::uint64_t at_us, Message message) { in_flight_.emplace(at_us, std::move(message)); }
  /// Calls take(message) for each message that has arrived.
  template <typename Take>
  void arrive(std::uint64_t now_us, Take take) {
    while (!in_flight_.empty() && in_flight_.begin()->first <= now_us) {
      const Message message = std::move(in_flight_.begin()->second);
      in_flight_.erase(in_flight_.begin());
      take(message);
    }
  }

 private:
  std::multimap<std::uint64_t, Message> in_flight_;
};

/// Model of the session: the order in which samples are applied.
struct SessionModel {
  std::uint64_t last = 0;
  std::uint32_t selected_tool = 1, tool = 0;
  bool lifted = true;
  /// Per sample: its time, which is unique, and whether a motion led to it.
  std::vector<std::pair<std::uint64_t, bool>> applied;
  std::uint64_t chords = 0;

  void select(std::uint32_t id) {
    if (selected_tool == id) return;
    selected_tool = id;
    lifted = true;
  }
  void apply(const wire::MotionSample& sample) {
    if (sample.agent_sequence <= last) return;
    if (last != 0 && sample.agent_sequence != last + 1) ++chords;
    last = sample.agent_sequence;
    applied.emplace_back(sample.time_us, !lifted && tool == sample.tool_id);
    tool = sample.tool_id;
    lifted = false;
  }
};

class Network {
 public:
  Network(const NetworkFaults& faults, std::uint64_t seed) : faults_(faults), random_(seed) {
    traffic_.begin(1, 1, now_us_, true);
  }

  /// Simulates one millisecond, in which the device yields `samples` samples.
  void step(int samples) {
    now_us_ += kStepUs;
    if (faults_.black_hole > 0 && happens(faults_.black_hole)) {
      outage_until_us_ = now_us_ + random_() % 900'000;
    }
    for (int i = 0; i < samples; ++i) make_sample();
    traffic_.collect();
    send();
    to_server_.arrive(now_us_, [&](const Frame& frame) { at_server(frame, false); });
    datagrams_to_server_.arrive(now_us_, [&](const Frame& frame) { at_server(frame, true); });
    to_agent_.arrive(now_us_,
                     [&](const Frame& f) { EXPECT_FALSE(traffic_.take_frame(f, now_us_)); });
    datagrams_to_agent_.arrive(
        now_us_, [&](const Frame& f) { EXPECT_FALSE(traffic_.take_datagram(f, now_us_)); });
  }

  void remove_faults() {
    faults_.loss = faults_.duplication = faults_.black_hole = faults_.ws_stall = 0;
  }
  bool settled() const { return traffic_.settled(); }
  LinkReport report() const { return traffic_.report(); }
  const SessionModel& session() const { return session_; }
  /// The expected SessionModel::applied: each sample, with a motion to it unless the tool changed.
  const std::vector<std::pair<std::uint64_t, bool>>& expected() const { return expected_; }

 private:
  bool happens(double share) {
    return std::uniform_real_distribution<double>(0, 1)(random_) < share;
  }

  void make_sample() {
    ++made_;
    const std::uint32_t before = tool_;
    if (happens(0.004)) tool_ = 3 - tool_;
    const double z = made_ % 2 == 0 ? 1 : 0;  // a zigzag: no sample may be merged
    const std::uint64_t time_us = now_us_ + made_ % 8;
    ASSERT_TRUE(ring_.push({.time_us = time_us,
                            .tip_mm = {0, 0, z},
                            .tool_id = tool_,
                            .buttons = wire::kButtonCutting}));
    expected_.emplace_back(time_us, made_ > 1 && tool_ == before);
  }

  /// As ServerLink's writing coroutine.
  void send() {
    std::array<std::byte, wire::kMaxClientFrameBytes> frame;
    for (;;) {
      while (const std::size_t bytes = traffic_.fill_datagram(
                 now_us_, std::span(frame).first(datagram::kMaxFrameBytes))) {
        post_datagram(datagrams_to_server_, Frame(frame.begin(), frame.begin() + long(bytes)));
      }
      if (const std::string text = traffic_.take_control(); !text.empty()) {
        const auto tool = nlohmann::json::parse(text).at("tool").get<std::uint8_t>();
        post(to_server_, last_to_server_us_, Frame(1, static_cast<std::byte>(tool)));
        continue;
      }
      const std::size_t bytes = traffic_.fill(now_us_, frame);
      if (bytes == 0) return;
      post(to_server_, last_to_server_us_, Frame(frame.begin(), frame.begin() + long(bytes)));
    }
  }

  void post(Channel<Frame>& channel, std::uint64_t& last_us, Frame frame) {
    std::uint64_t at_us = now_us_ + faults_.ws_delay_us;
    if (happens(faults_.ws_stall)) at_us += 250'000;
    last_us = std::max(last_us, at_us);
    channel.put(last_us, std::move(frame));
  }

  void post_datagram(Channel<Frame>& channel, const Frame& frame) {
    if (now_us_ < outage_until_us_ || happens(faults_.loss)) return;
    for (int copies = happens(faults_.duplication) ? 2 : 1; copies > 0; --copies) {
      channel.put(now_us_ + faults_.udp_delay_us + random_() % (faults_.udp_jitter_us + 1), frame);
    }
  }

  /// As the server's agent connection.
  void at_server(const Frame& frame, bool udp) {
    if (frame.size() == 1) return session_.select(std::to_integer<std::uint32_t>(frame[0]));
    const auto message = wire::decode(frame);
    ASSERT_TRUE(message);
    if (const auto* ping = std::get_if<wire::Ping>(&message->body)) {
      return answer(wire::Pong{ping->time_us, now_us_}, udp);
    }
    const auto& batch = std::get<wire::MotionBatch>(message->body);
    const auto arrival = udp ? gate_.judge(batch) : net::Arrival::kNew;
    if (arrival == net::Arrival::kNew) {
      for (const auto& sample : batch.view()) session_.apply(sample);
    }
    gate_.applied(session_.last);
    answer(wire::Result{.agent_sequence = session_.last,
                        .status = arrival == net::Arrival::kGap ? wire::kStatusGap : 0U},
           udp);
  }

  template <typename Body>
  void answer(const Body& body, bool udp) {
    Frame frame;
    wire::append(frame, {.epoch = 1, .sequence = ++sequence_, .time_us = now_us_}, body);
    if (udp) return post_datagram(datagrams_to_agent_, frame);
    post(to_agent_, last_to_agent_us_, std::move(frame));
  }

  NetworkFaults faults_;
  std::mt19937_64 random_;
  SampleRing ring_;
  LatestValue<ServerWrench> wrenches_;
  Traffic traffic_{ring_, wrenches_};
  net::SampleGate gate_;
  SessionModel session_;
  Channel<Frame> to_server_, to_agent_, datagrams_to_server_, datagrams_to_agent_;
  std::uint64_t last_to_server_us_ = 0, last_to_agent_us_ = 0;
  std::uint64_t now_us_ = 1'000'000, outage_until_us_ = 0, made_ = 0, sequence_ = 0;
  std::uint32_t tool_ = 1;
  std::vector<std::pair<std::uint64_t, bool>> expected_;
};

NetworkFaults random_faults(std::mt19937_64& random) {
  const auto up_to = [&](double most) {
    return std::uniform_real_distribution<double>(0, most)(random);
  };
  return {.loss = random() % 4 == 0 ? up_to(0.6) : up_to(0.1),
          .duplication = up_to(0.2),
          .udp_delay_us = random() % 60'000,
          .udp_jitter_us = random() % 40'000,
          .ws_delay_us = random() % 60'000,
          .ws_stall = up_to(0.02),
          .black_hole = random() % 3 == 0 ? 0.001 : 0};
}

TEST(TransportProperty, EachSampleIsAppliedOnceInOrderOverAnyNetwork) {
  std::mt19937_64 random(2);
  std::uint64_t over_udp = 0, gaps = 0, fell_back = 0;
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    Network network(random_faults(random), seed);
    for (int ms = 0; ms < 3000; ++ms) network.step(random() % 50 == 0 ? 4 : ms % 10 == 0 ? 0 : 1);
    network.remove_faults();
    for (int ms = 0; ms < 20'000 && !network.settled(); ++ms) network.step(0);
    ASSERT_TRUE(network.settled()) << "seed " << seed;
    const LinkReport report = network.report();
    ASSERT_EQ(report.merged_cuts + report.thinned_cuts + report.merged_air, 0U);
    ASSERT_EQ(network.session().chords, 0U) << "seed " << seed;
    const auto& applied = network.session().applied;
    const auto differs = std::ranges::mismatch(applied, network.expected());
    ASSERT_TRUE(differs.in1 == applied.end() && differs.in2 == network.expected().end())
        << "seed " << seed << ", sample " << differs.in1 - applied.begin() << " of "
        << applied.size() << "; expected are " << network.expected().size();
    over_udp += report.udp.samples;
    gaps += report.udp.gaps;
    fell_back += report.udp.fell_back;
  }
  // The simulations covered UDP, gaps and fallbacks.
  EXPECT_GT(over_udp, 100'000U);
  EXPECT_GT(gaps, 100U);
  EXPECT_GT(fell_back, 10U);
}

}  // namespace
}  // namespace kerf::agent
