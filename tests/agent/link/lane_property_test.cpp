// SPDX-License-Identifier: Apache-2.0
// Whatever a network does, each sample is applied once, in order, each motion where it was made.
// The agent's traffic and the server's gate, on a made-up network and a made-up clock, many times
// over.
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

/// How bad this network is.
struct Weather {
  double loss = 0, duplication = 0;
  std::uint64_t udp_delay_us = 0, udp_jitter_us = 0, ws_delay_us = 0;
  double ws_stall = 0;    ///< of a message: it comes 250 ms late, and so does all behind it
  double black_hole = 0;  ///< each ms: a time without UDP begins
};

/// Messages under way to one end, by when they arrive.
template <typename Message>
class Way {
 public:
  void put(std::uint64_t at_us, Message message) { way_.emplace(at_us, std::move(message)); }
  /// Each that has arrived.
  template <typename Take>
  void arrive(std::uint64_t now_us, Take take) {
    while (!way_.empty() && way_.begin()->first <= now_us) {
      const Message message = std::move(way_.begin()->second);
      way_.erase(way_.begin());
      take(message);
    }
  }

 private:
  std::multimap<std::uint64_t, Message> way_;
};

/// What the session does with samples, as far as their order goes.
struct Seat {
  std::uint64_t last = 0;
  std::uint32_t told_tool = 1, tool = 0;
  bool lifted = true;
  /// Of each sample: its time, which tells it from all others, and whether a motion led to it.
  std::vector<std::pair<std::uint64_t, bool>> applied;
  std::uint64_t chords = 0;

  void choose(std::uint32_t told) {
    if (told_tool == told) return;
    told_tool = told;
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
  Network(const Weather& weather, std::uint64_t seed) : weather_(weather), random_(seed) {
    traffic_.begin(1, 1, now_us_, true);
  }

  /// One millisecond, in which the hand gives so many samples.
  void step(int samples) {
    now_us_ += kStepUs;
    if (weather_.black_hole > 0 && happens(weather_.black_hole)) {
      dark_until_us_ = now_us_ + random_() % 900'000;
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

  void clear_up() {
    weather_.loss = weather_.duplication = weather_.black_hole = weather_.ws_stall = 0;
  }
  bool settled() const { return traffic_.settled(); }
  LinkReport report() const { return traffic_.report(); }
  const Seat& seat() const { return seat_; }
  /// What the seat should have: each sample, and a motion to it unless it begins a tool.
  const std::vector<std::pair<std::uint64_t, bool>>& expected() const { return expected_; }

 private:
  bool happens(double share) {
    return std::uniform_real_distribution<double>(0, 1)(random_) < share;
  }

  void make_sample() {
    ++made_;
    const std::uint32_t before = tool_;
    if (happens(0.004)) tool_ = 3 - tool_;
    const double z = made_ % 2 == 0 ? 1 : 0;  // bent: nothing of it may be left out
    const std::uint64_t time_us = now_us_ + made_ % 8;
    ASSERT_TRUE(ring_.push({.time_us = time_us,
                            .tip_mm = {0, 0, z},
                            .tool_id = tool_,
                            .buttons = wire::kButtonCutting}));
    expected_.emplace_back(time_us, made_ > 1 && tool_ == before);
  }

  /// As the link's writing loop does.
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

  void post(Way<Frame>& way, std::uint64_t& last_us, Frame frame) {
    std::uint64_t at_us = now_us_ + weather_.ws_delay_us;
    if (happens(weather_.ws_stall)) at_us += 250'000;
    last_us = std::max(last_us, at_us);
    way.put(last_us, std::move(frame));
  }

  void post_datagram(Way<Frame>& way, const Frame& frame) {
    if (now_us_ < dark_until_us_ || happens(weather_.loss)) return;
    for (int copies = happens(weather_.duplication) ? 2 : 1; copies > 0; --copies) {
      way.put(now_us_ + weather_.udp_delay_us + random_() % (weather_.udp_jitter_us + 1), frame);
    }
  }

  /// As the server's AgentSocket does.
  void at_server(const Frame& frame, bool udp) {
    if (frame.size() == 1) return seat_.choose(std::to_integer<std::uint32_t>(frame[0]));
    const auto message = wire::decode(frame);
    ASSERT_TRUE(message);
    if (const auto* ping = std::get_if<wire::Ping>(&message->body)) {
      return answer(wire::Pong{ping->time_us, now_us_}, udp);
    }
    const auto& batch = std::get<wire::MotionBatch>(message->body);
    const auto arrival = udp ? gate_.judge(batch) : net::Arrival::kNew;
    if (arrival == net::Arrival::kNew) {
      for (const auto& sample : batch.view()) seat_.apply(sample);
    }
    gate_.applied(seat_.last);
    answer(wire::Result{.agent_sequence = seat_.last,
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

  Weather weather_;
  std::mt19937_64 random_;
  SampleRing ring_;
  LatestValue<ServerWrench> wrenches_;
  Traffic traffic_{ring_, wrenches_};
  net::SampleGate gate_;
  Seat seat_;
  Way<Frame> to_server_, to_agent_, datagrams_to_server_, datagrams_to_agent_;
  std::uint64_t last_to_server_us_ = 0, last_to_agent_us_ = 0;
  std::uint64_t now_us_ = 1'000'000, dark_until_us_ = 0, made_ = 0, sequence_ = 0;
  std::uint32_t tool_ = 1;
  std::vector<std::pair<std::uint64_t, bool>> expected_;
};

Weather random_weather(std::mt19937_64& random) {
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

TEST(LaneProperty, EachSampleIsAppliedOnceInOrderWhateverTheNetworkDoes) {
  std::mt19937_64 random(2);
  std::uint64_t over_udp = 0, gaps = 0, fell_back = 0;
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    Network network(random_weather(random), seed);
    for (int ms = 0; ms < 3000; ++ms) network.step(random() % 50 == 0 ? 4 : ms % 10 == 0 ? 0 : 1);
    network.clear_up();
    for (int ms = 0; ms < 20'000 && !network.settled(); ++ms) network.step(0);
    ASSERT_TRUE(network.settled()) << "seed " << seed;
    const LinkReport report = network.report();
    ASSERT_EQ(report.merged_cuts + report.thinned_cuts + report.merged_air, 0U);
    ASSERT_EQ(network.seat().chords, 0U) << "seed " << seed;
    const auto& applied = network.seat().applied;
    const auto differs = std::ranges::mismatch(applied, network.expected());
    ASSERT_TRUE(differs.in1 == applied.end() && differs.in2 == network.expected().end())
        << "seed " << seed << ", sample " << differs.in1 - applied.begin() << " of "
        << applied.size() << "; expected are " << network.expected().size();
    over_udp += report.udp.samples;
    gaps += report.udp.gaps;
    fell_back += report.udp.fell_back;
  }
  // All of it has been there.
  EXPECT_GT(over_udp, 100'000U);
  EXPECT_GT(gaps, 100U);
  EXPECT_GT(fell_back, 10U);
}

}  // namespace
}  // namespace kerf::agent
