// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <mutex>
#include <span>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "haptic_agent/link/server_link.h"
#include "haptic_agent/realtime/clock.h"
#include "tests/bench/live_client.h"

namespace kerf::bench {

/// The block that carvers cut, each in its own quarter.
inline constexpr const char* kCarverScene = R"({"name":"kill",
  "stock":{"shape":"box","min_mm":[-100,-100,-40],"max_mm":[100,100,0]},
  "accuracy":{"rays":"dexel","pitch_mm":0.5,"tolerance_mm":0.01,"motion":"tight"},
  "tools":[{"id":1,"shape":"ball","diameter_mm":6,"length_mm":60}],
  "machine":{"kinematics":"tool-vector"}})";
inline constexpr int kCarvers = 4;

/// An agent that carves line after line of its own quarter of the block, layer after layer.
class LineCarver final : public agent::StockListener {
 public:
  LineCarver(int number, std::uint16_t port, const std::string& session)
      : y_mm_(-97.0 + 50.0 * number),
        link_({.server = {.host = "127.0.0.1", .port = std::to_string(port)},
               .session = session,
               .hello = {.name = "carver " + std::to_string(number), .color = "", .tool_id = 1},
               .traffic = {.copy = this},
               .patience_s = 300,
               .notice = {},
               .failed = {}},
              ring_, wrenches_) {
    link_.start();
    const auto welcome = link_.wait_welcome();
    if (!welcome) fail(welcome.error());
    participant_ = welcome->participant;
    thread_ = std::thread([this] { run(); });
  }
  ~LineCarver() override {
    stop_.store(true);
    thread_.join();
  }

  void move(bool moving) { moving_.store(moving); }
  /// Waits until the samples made so far are answered. Returns false if that takes too long.
  bool settle() const {
    constexpr auto kSettleLimit = std::chrono::seconds(60);
    const auto end = Clock::now() + kSettleLimit;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));  // a sample that is being made
    while (felt_.load() < made_.load()) {
      if (Clock::now() > end) return false;
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    return true;
  }
  agent::LinkReport finish() {
    link_.stop(10);
    return link_.report();
  }
  std::uint64_t felt() const { return felt_.load(); }
  std::uint64_t durable() const { return durable_.load(); }
  ParticipantId participant() const { return participant_; }
  /// Returns the poses made since the last call.
  std::vector<wire::MotionSample> take_made() {
    const std::scoped_lock lock(mutex_);
    return std::exchange(samples_, {});
  }
  /// Returns the numbers, from 1 on, of the samples that were answered and not rejected since the
  /// last call of take_cut().
  std::vector<std::uint64_t> cut() const {
    const std::scoped_lock lock(mutex_);
    return cut_;
  }
  std::vector<std::uint64_t> take_cut() {
    const std::scoped_lock lock(mutex_);
    return std::exchange(cut_, {});
  }

  void take_stock(std::span<const std::byte>) override {}
  void take_result(const wire::Result& result) override {
    if ((result.status & wire::kStatusRejected) == 0) {
      const std::scoped_lock lock(mutex_);
      for (std::uint64_t n = felt_.load() + 1; n <= result.agent_sequence; ++n) cut_.push_back(n);
    }
    felt_.store(std::max(felt_.load(), result.agent_sequence));
    durable_.store(std::max(durable_.load(), result.durable_sequence));
  }
  bool wants_reset() override { return false; }

 private:
  void run() {
    /// A user whose agent has lost its server stops moving.
    constexpr std::uint64_t kUnansweredMax = 2000;
    auto next = Clock::now();
    while (!stop_.load()) {
      next = std::max(next + std::chrono::milliseconds(1),
                      Clock::now() - std::chrono::milliseconds(20));
      std::this_thread::sleep_until(next);
      if (!moving_.load() || made_.load() > felt_.load() + kUnansweredMax) continue;
      make_sample();
    }
  }
  void make_sample() {
    constexpr double kStepMm = 0.1, kLineMm = 190, kLinesPerLayer = 40;
    const double along = kStepMm * static_cast<double>(made_.load());
    const double line = std::floor(along / kLineMm), layer = std::floor(line / kLinesPerLayer);
    const double x = along - line * kLineMm;
    // A thread that was late makes several samples at once, which must not look like a fast motion.
    last_us_ = std::max(last_us_ + 900, agent::monotonic_us());
    // No three samples are on a line, so that a backlog is not shortened.
    const double zigzag = made_.load() % 2 == 0 ? 0.03 : 0;
    const wire::MotionSample sample{
        .time_us = last_us_,
        .tip_mm = {std::fmod(line, 2) == 0 ? x - kLineMm / 2 : kLineMm / 2 - x,
                   y_mm_ + line - layer * kLinesPerLayer + along * 1e-4, -1 - layer - zigzag},
        .tool_id = 1,
        .buttons = wire::kButtonCutting};
    {
      const std::scoped_lock lock(mutex_);
      samples_.push_back(sample);
    }
    made_.fetch_add(1);
    if (!ring_.push(sample)) fail("the ring of samples is full");
    link_.sample_ready();
  }

  double y_mm_;
  std::uint64_t last_us_ = 0;
  agent::SampleRing ring_;
  agent::LatestValue<agent::ServerWrench> wrenches_;
  std::atomic<std::uint64_t> felt_{0}, durable_{0}, made_{0};
  std::atomic<bool> moving_{false}, stop_{false};
  mutable std::mutex mutex_;
  std::vector<wire::MotionSample> samples_;
  std::vector<std::uint64_t> cut_;
  ParticipantId participant_ = 0;
  agent::ServerLink link_;
  std::thread thread_;
};

}  // namespace kerf::bench
