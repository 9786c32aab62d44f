// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/link/pace.h"

#include "haptic_agent/link/sample_queue.h"
#include "server/platform/clock.h"
#include "server/session/rate_limit.h"
#include "server/session/session_limits.h"
#include "tests/support/test.h"

namespace kerf::agent::pace_test {
namespace {

TEST(Pace, SendsABacklogSlightlyFasterThanItGrows) {
  Pace pace;
  std::uint64_t now_us = 1'000'000;
  std::size_t sent = pace.allowed(now_us);
  EXPECT_EQ(sent, 900U);
  pace.sent(sent);
  EXPECT_EQ(pace.allowed(now_us), 0U);
  for (int i = 0; i < 1000; ++i) {
    now_us += 10'000;
    const std::size_t now = pace.allowed(now_us);
    pace.sent(now);
    sent += now;
  }
  EXPECT_NEAR(static_cast<double>(sent), 900 + 12'250, 2);
}

/// An agent that moves at 1 kHz, the line to its server, and the server's rate limit.
class PacedLine {
 public:
  PacedLine(bool over_udp, std::uint64_t seed) : over_udp_(over_udp), random_(seed) {
    queue_.keep_until_durable(true);
    queue_.set_rtt(SampleQueue::kMaxRttUs);
  }

  void run(int ms, bool connected) {
    for (const std::uint64_t end_us = now_us_ + 1000 * static_cast<std::uint64_t>(ms);
         now_us_ < end_us; now_us_ += 1000) {
      make_sample();
      if (!connected) continue;
      send();
      serve();
    }
  }
  /// A server that starts from zero because no answered sample was durable: all are resent.
  void restart_server() {
    in_transit_.clear();
    limit_ = fresh_limit();
    server_has_ = 0;
    queue_.rewind();
  }
  std::uint64_t refused() const { return refused_; }
  std::uint64_t server_has() const { return server_has_; }

 private:
  static RateLimit fresh_limit() {
    const SessionLimits limits;
    return {limits.samples_per_s, limits.samples_burst};
  }
  void make_sample() {
    const auto made = static_cast<double>(++made_);
    // No three samples are collinear, so none are merged.
    const double zigzag = made_ % 2 == 0 ? 1 : 0;
    queue_.push({.time_us = now_us_,
                 .tip_mm = {made, zigzag, 0},
                 .tool_id = 1,
                 .buttons = wire::kButtonCutting});
  }
  void send() {
    for (;;) {
      wire::MotionBatch batch;
      const std::size_t most = pace_.allowed(now_us_);
      if (over_udp_) {
        const auto out = queue_.take_repeating(most, 1);
        pace_.sent(out.fresh);
        batch = out.batch;
      } else {
        batch = queue_.take(most);
        pace_.sent(batch.count);
      }
      if (batch.count == 0) return;
      in_transit_.push_back(batch);
    }
  }
  /// At times the line or the server stalls and then delivers everything at once.
  void serve() {
    if (now_us_ < stalled_until_us_) return;
    if (random_() % 300 == 0) stalled_until_us_ = now_us_ + random_() % 3'000'000;
    for (; !in_transit_.empty(); in_transit_.pop_front()) {
      const wire::MotionBatch& batch = in_transit_.front();
      for (std::uint32_t i = 0; i < batch.count; ++i) take(batch.samples[i].agent_sequence);
    }
    queue_.answered(server_has_);
  }
  void take(std::uint64_t number) {
    if (number <= server_has_) return;
    server_has_ = number;
    const kerf::Clock::time_point now{std::chrono::microseconds(now_us_)};
    refused_ += limit_.allow(now) ? 0 : 1;
  }

  bool over_udp_;
  std::mt19937_64 random_;
  SampleQueue queue_;
  Pace pace_;
  RateLimit limit_ = fresh_limit();
  std::deque<wire::MotionBatch> in_transit_;
  std::uint64_t now_us_ = 1'000'000, stalled_until_us_ = 0;
  std::uint64_t made_ = 0, server_has_ = 0, refused_ = 0;
};

TEST(Pace, KeepsBelowTheLimitOfASessionHoweverLateItsSamplesArrive) {
  for (const bool over_udp : {false, true}) {
    for (std::uint64_t seed = 0; seed < 40; ++seed) {
      SCOPED_TRACE((over_udp ? "UDP, seed " : "WebSocket, seed ") + std::to_string(seed));
      PacedLine line(over_udp, seed);
      line.run(4000, true);
      const std::uint64_t had = line.server_has();
      line.run(2000, false);
      line.restart_server();
      line.run(15'000, true);
      EXPECT_EQ(line.refused(), 0U);
      EXPECT_GT(line.server_has(), had + 5000);
    }
  }
}

}  // namespace
}  // namespace kerf::agent::pace_test
