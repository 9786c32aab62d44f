// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sched.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <string>
#include <thread>
#include <vector>

#include "server/wire/codec.h"
#include "tests/bench/crowd_viewer.h"
#include "tests/bench/live_client.h"
#include "tests/bench/raster_agent.h"

namespace kerf::bench {

/// Returns a scene with a block high enough for all layers of a raster of this many seconds.
inline std::string scene_for(double seconds) {
  const double layers = std::ceil(1000 * seconds / double(kLayer)) + 2;
  return R"({"name": "bench",
  "stock": {"shape": "box", "min_mm": [-40, -40, )" +
         std::to_string(-30 - kDownMm * layers) + R"(], "max_mm": [40, 40, 0]},
  "accuracy": {"rays": "dexel", "pitch_mm": 0.5, "tolerance_mm": 0.01, "motion": "tight"},
  "tools": [{"id": 1, "shape": "ball", "diameter_mm": 10, "length_mm": 60},
            {"id": 2, "shape": "flat", "diameter_mm": 6, "length_mm": 60}]})";
}

/// Cuts the raster at 1 kHz from sample `first` to `end`; returns the round trips, us.
inline std::vector<double> cut_raster(WebSocket& agent, std::uint64_t first, std::uint64_t end,
                                      std::uint64_t ahead, AnswerTimes* answers) {
  std::vector<double> trips_us;
  std::vector<Clock::time_point> sent(end);
  std::string payload;
  std::vector<std::byte> frame;
  std::uint64_t answered = 0;
  const auto take = [&](Clock::time_point until) {
    const auto opcode = agent.receive(payload, until);
    if (opcode != 2) return opcode != 0;
    const auto message = wire::decode(std::as_bytes(std::span(payload)));
    if (!message) fail("a frame of the server is malformed");
    const auto* result = std::get_if<wire::Result>(&message->body);
    if (result != nullptr && result->agent_sequence >= first) {
      if (answers != nullptr) answers->answered(result->motions_applied);
      trips_us.push_back(
          std::chrono::duration<double, std::micro>(Clock::now() - sent.at(result->agent_sequence))
              .count());
      answered = result->agent_sequence;
    } else if (std::holds_alternative<wire::StockPatch>(message->body)) {
      frame.clear();
      wire::append(frame, {kNewEpoch, message->header.stamp.sequence, 0}, wire::Ack{});
      agent.send(2, frame);
    }
    return true;
  };
  const auto start = Clock::now();
  for (std::uint64_t n = first; n < end; ++n) {
    const auto tick = start + std::chrono::milliseconds(n - first);
    while (Clock::now() < tick) take(tick);
    wire::MotionBatch batch{.count = 1};
    batch.samples[0] = sample_at(n, ahead);
    frame.clear();
    wire::append(frame, {kNewEpoch, n, n * 1000}, batch);
    sent[n] = Clock::now();
    agent.send(2, frame);
  }
  // A sample that was rejected, because earlier ones waited too long, is not answered.
  while (answered + 1 < end && take(in_seconds(2))) continue;
  return trips_us;
}

/// Sorts the values and returns the value below which this share of them is.
inline double at_share(std::vector<double>& values, double share) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(share * double(values.size() - 1))];
}

/// The agents of one session.
class Raster {
 public:
  /// `answers` records when their motions were answered, or is null.
  Raster(std::uint16_t port, const std::string& session, int agents, AnswerTimes* answers)
      : thread_name_("s:" + session), answers_(answers) {
    for (int n = 0; n < agents; ++n) agents_.push_back(join_agent(port, session));
  }
  /// Returns the name of the session's thread in the server.
  const std::string& thread_name() const { return thread_name_; }
  /// Cuts `count` more samples with each agent. Returns the round trips, us.
  std::vector<double> cut(std::uint64_t count) {
    std::vector<std::vector<double>> trips(agents_.size());
    {
      std::vector<std::jthread> threads;
      for (std::size_t n = 0; n < agents_.size(); ++n) {
        threads.emplace_back([&, n] {
          const sched_param priority{.sched_priority = 60};
          sched_setscheduler(0, SCHED_FIFO, &priority);
          trips[n] =
              cut_raster(agents_[n], next_, next_ + count, n * kLayer / agents_.size(), answers_);
        });
      }
    }
    next_ += count;
    std::vector<double> all;
    for (const auto& some : trips) all.insert(all.end(), some.begin(), some.end());
    return all;
  }

 private:
  std::string thread_name_;
  std::vector<WebSocket> agents_;
  AnswerTimes* answers_;
  std::uint64_t next_ = 1;  ///< sample
};

}  // namespace kerf::bench
