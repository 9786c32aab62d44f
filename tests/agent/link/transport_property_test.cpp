// SPDX-License-Identifier: Apache-2.0
// Over any network each sample is applied once, in order, and each motion at its position. The
// agent's Traffic and the server's AgentConversation run on a simulated network and a simulated
// clock.
#include "haptic_agent/link/traffic.h"
#include "server/conversation/agent_conversation.h"
#include "server/datagram/layout.h"
#include "server/platform/clock.h"
#include "server/store/journal_reader.h"
#include "server/wire/codec.h"
#include "tests/server/session_fixture.h"
#include "tests/support/test.h"

namespace kerf::agent::transport_property_test {
namespace {

using Frame = std::vector<std::byte>;

constexpr std::uint64_t kStepUs = 1000;

/// The faults of a network.
struct NetworkFaults {
  double loss = 0, duplication = 0;
  std::uint64_t udp_delay_us = 0, udp_jitter_us = 0, ws_delay_us = 0;
  double ws_stall = 0;    ///< share of messages that are 250 ms late, with all messages behind them
  double black_hole = 0;  ///< probability per ms that UDP is interrupted
};

/// Messages in transit in one direction, by time of arrival.
class Transit {
 public:
  void put(std::uint64_t at_us, Frame message) { messages_.emplace(at_us, std::move(message)); }
  /// Calls `take` for each message that has arrived.
  template <typename Take>
  void arrive(std::uint64_t now_us, Take take) {
    while (!messages_.empty() && messages_.begin()->first <= now_us) {
      const Frame message = std::move(messages_.begin()->second);
      messages_.erase(messages_.begin());
      take(message);
    }
  }

 private:
  std::multimap<std::uint64_t, Frame> messages_;
};

/// A motion that the session must apply.
struct Motion {
  ToolId tool = 0;
  Vec3 from_mm, to_mm;
};

/// The session rounds positions to 1e-6 mm.
bool are_equal(const Motion& a, const Motion& b) {
  return a.tool == b.tool && length(a.from_mm - b.from_mm) < 1e-5 &&
         length(a.to_mm - b.to_mm) < 1e-5;
}

/// One agent, one session and the network between them.
class Network {
 public:
  Network(const NetworkFaults& faults, std::uint64_t seed, const std::shared_ptr<Session>& session,
          const SessionLimits& limits, net::Metrics& metrics)
      : faults_(faults),
        random_(seed),
        server_({.session = session,
                 .limits = limits,
                 .metrics = metrics,
                 .now = [this] { return time(); },
                 .wake = {},
                 .open_udp = [] { return datagram::Offer{.port = 1, .connection = 1}; }}) {
    const std::string_view hello = R"({"type":"hello","name":"Ada","tool":1,"udp":true})";
    server_.receive(std::as_bytes(std::span(hello)), true, time());
    EXPECT_TRUE(server_.has_joined());
    traffic_.begin(session->epoch(), 1, now_us_, true);
  }

  /// Advances by one millisecond, in which the device delivers `samples` samples.
  void step(int samples) {
    now_us_ += kStepUs;
    if (faults_.black_hole > 0 && happens(faults_.black_hole)) {
      dark_until_us_ = now_us_ + random_() % 900'000;
    }
    for (int i = 0; i < samples; ++i) make_sample();
    traffic_.collect();
    send();
    to_server_.arrive(now_us_, [&](const Frame& frame) { at_server(frame); });
    datagrams_to_server_.arrive(now_us_, [&](const Frame& frame) { datagram_at_server(frame); });
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
  void leave() { server_.end(); }
  /// One motion per sample, except for the first sample of a tool.
  const std::vector<Motion>& expected() const { return expected_; }

 private:
  bool happens(double share) {
    return std::uniform_real_distribution<double>(0, 1)(random_) < share;
  }
  kerf::Clock::time_point time() const {
    return kerf::Clock::time_point(std::chrono::microseconds(now_us_));
  }

  void make_sample() {
    ++made_;
    const std::uint32_t before = tool_;
    if (happens(0.004)) tool_ = 3 - tool_;
    // No three samples are collinear, so none may be omitted. Each position occurs once. All
    // motions are outside the block, because only their order matters here.
    const Vec3 tip{30 + 1e-3 * static_cast<double>(made_), 0, made_ % 2 == 0 ? 21.0 : 20.0};
    last_time_us_ = std::max(last_time_us_ + 1, now_us_);
    ASSERT_TRUE(ring_.push({.time_us = last_time_us_,
                            .tip_mm = {tip.x, tip.y, tip.z},
                            .tool_id = tool_,
                            .buttons = wire::kButtonCutting}));
    if (made_ > 1 && tool_ == before) expected_.push_back({tool_, last_tip_, tip});
    last_tip_ = tip;
  }

  /// Sends like the writing loop of the link.
  void send() {
    std::array<std::byte, wire::kMaxClientFrameBytes> frame;
    for (;;) {
      while (const std::size_t bytes = traffic_.fill_datagram(
                 now_us_, std::span(frame).first(datagram::kMaxFrameBytes))) {
        post_datagram(datagrams_to_server_, std::span(frame).first(bytes));
      }
      if (const std::string text = traffic_.take_control(now_us_); !text.empty()) {
        post(to_server_, last_to_server_us_, std::as_bytes(std::span(text)));
        continue;
      }
      const std::size_t bytes = traffic_.fill(now_us_, frame);
      if (bytes == 0) return;
      post(to_server_, last_to_server_us_, std::span(frame).first(bytes));
    }
  }

  void post(Transit& transit, std::uint64_t& last_us, std::span<const std::byte> frame) {
    std::uint64_t at_us = now_us_ + faults_.ws_delay_us;
    if (happens(faults_.ws_stall)) at_us += 250'000;
    last_us = std::max(last_us, at_us);
    transit.put(last_us, Frame(frame.begin(), frame.end()));
  }

  void post_datagram(Transit& transit, std::span<const std::byte> frame) {
    if (now_us_ < dark_until_us_ || happens(faults_.loss)) return;
    for (int copies = happens(faults_.duplication) ? 2 : 1; copies > 0; --copies) {
      transit.put(now_us_ + faults_.udp_delay_us + random_() % (faults_.udp_jitter_us + 1),
                  Frame(frame.begin(), frame.end()));
    }
  }

  void at_server(const Frame& frame) {
    server_.receive(frame, frame.front() == std::byte{'{'}, time());
    net::OutFrame out;
    while (server_.take(out)) {
      if (!out.is_text()) post(to_agent_, last_to_agent_us_, out.bytes);
    }
    server_.refresh();
  }

  void datagram_at_server(const Frame& frame) {
    server_.receive_datagram(frame, time());
    while (const net::OutDatagram* out = server_.take_datagram()) {
      post_datagram(datagrams_to_agent_, out->frame());
    }
    server_.refresh();
  }

  NetworkFaults faults_;
  std::mt19937_64 random_;
  SampleRing ring_;
  LatestValue<ServerWrench> wrenches_;
  Traffic traffic_{ring_, wrenches_};
  std::uint64_t now_us_ = 1'000'000, dark_until_us_ = 0, made_ = 0, last_time_us_ = 0;
  net::AgentConversation server_;
  Transit to_server_, to_agent_, datagrams_to_server_, datagrams_to_agent_;
  std::uint64_t last_to_server_us_ = 0, last_to_agent_us_ = 0;
  std::uint32_t tool_ = 1;
  Vec3 last_tip_;
  std::vector<Motion> expected_;
};

/// The motions in the session's journal, in order.
std::vector<Motion> journaled(Session& session) {
  std::vector<Motion> motions;
  EXPECT_TRUE(session.flush());
  auto reader = JournalReader::open(session.journal_file());
  EXPECT_TRUE(reader);
  for (;;) {
    const auto record = reader->next();
    EXPECT_TRUE(record);
    if (!record || !record->has_value()) return motions;
    if (const auto* move = std::get_if<MoveTool>(&(*record)->command)) {
      motions.push_back({move->tool, move->from.tip_mm, move->to.tip_mm});
    }
  }
}

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

std::string describe(std::vector<Motion>::const_iterator at, const std::vector<Motion>& motions) {
  if (at == motions.end()) return "the end";
  std::array<char, 160> text{};
  std::snprintf(text.data(), text.size(), "tool %u from (%.17g, %g, %g) to (%.17g, %g, %g)",
                at->tool, at->from_mm.x, at->from_mm.y, at->from_mm.z, at->to_mm.x, at->to_mm.y,
                at->to_mm.z);
  return text.data();
}

class TransportProperty : public SessionTest {
 protected:
  void SetUp() override {
    // The session limits rates by the real clock, which is slower than the simulated one.
    limits.samples_per_s = limits.samples_burst = limits.speed_mm_per_s = 1e12;
    SessionTest::SetUp();
  }
  net::Metrics metrics;
};

TEST_F(TransportProperty, EachSampleIsAppliedOnceAndInOrder) {
  std::mt19937_64 random(2);
  std::uint64_t over_udp = 0, gaps = 0, fell_back = 0;
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    restart();
    const auto session = *registry->create("s" + std::to_string(seed), kScene, SceneSource{});
    Network network(random_faults(random), seed, session, limits, metrics);
    for (int ms = 0; ms < 3000; ++ms) network.step(random() % 50 == 0 ? 4 : ms % 10 == 0 ? 0 : 1);
    network.remove_faults();
    for (int ms = 0; ms < 20'000 && !network.settled(); ++ms) network.step(0);
    ASSERT_TRUE(network.settled());
    const LinkReport report = network.report();
    ASSERT_EQ(report.merged_cuts + report.thinned_cuts + report.merged_air, 0U);
    const std::vector<Motion> applied = journaled(*session);
    const auto differs = std::ranges::mismatch(applied, network.expected(), are_equal);
    ASSERT_TRUE(differs.in1 == applied.end() && differs.in2 == network.expected().end())
        << "motion " << differs.in1 - applied.begin() << " of " << applied.size()
        << "; expected are " << network.expected().size() << ": " << describe(differs.in1, applied)
        << " instead of " << describe(differs.in2, network.expected());
    over_udp += report.udp.samples;
    gaps += report.udp.gaps;
    fell_back += report.udp.fell_back;
    network.leave();
  }
  // All of these cases have occurred.
  EXPECT_GT(over_udp, 30'000U);
  EXPECT_GT(gaps, 30U);
  EXPECT_GT(fell_back, 3U);
}

}  // namespace
}  // namespace kerf::agent::transport_property_test
