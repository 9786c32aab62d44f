// SPDX-License-Identifier: Apache-2.0
#include "tests/sim/world/hand.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "haptic_agent/realtime/clock.h"

namespace kerf::sim {

Hand::Hand(int number, std::string session, int port, std::uint64_t seed, std::string token)
    : name_("hand " + std::to_string(number)), y_mm_(-12.0 + 6.0 * number), random_(seed | 1) {
  agent::LinkSettings settings{
      .server = {"127.0.0.1", std::to_string(port), false},
      .session = std::move(session),
      .token = std::move(token),
      .hello = {.name = name_, .tool_id = 1},
      .patience_s = 120,
      .notice = [this](const std::string& line) { notices_.push_back(line); }};
  link_ = std::make_unique<agent::ServerLink>(std::move(settings), ring_, wrenches_);
}

void Hand::move() {
  ++made_;
  random_ = random_ * 6364136223846793005 + 1442695040888963407;
  const std::uint32_t before = tool_;
  if ((random_ >> 33) % 100 == 0) tool_ = 3 - tool_;
  const auto count = static_cast<double>(made_);
  const Vec3 tip{18 * std::sin(0.003 * count), y_mm_ + 0.0003 * count,
                 -0.5 - 0.0005 * count - (made_ % 2 == 0 ? 0.2 : 0.0)};
  last_us_ = std::max(last_us_ + 1, agent::monotonic_us());
  wire::MotionSample sample{
      .time_us = last_us_, .tip_mm = tip, .tool_id = tool_, .buttons = wire::kButtonCutting};
  if (!ring_.push(sample)) {
    --made_;
    tool_ = before;
    return;
  }
  if (made_ > 1 && tool_ == before) motions_.push_back({tool_, tip_mm_, tip});
  tip_mm_ = tip;
  link_->sample_ready();
}

void Hand::run(Time end, Time period, Time patience) {
  link_->start();
  const auto welcome = link_->wait_welcome();
  if (welcome) participant_ = welcome->participant;
  while (now() < end && welcome) {
    move();
    std::this_thread::sleep_for(std::chrono::nanoseconds(period));
  }
  link_->stop(static_cast<double>(patience) / static_cast<double>(kSecond));
}

void Hand::start(Time end, Time period, Time patience) {
  thread_ = std::thread([this, end, period, patience] { run(end, period, patience); });
}

}  // namespace kerf::sim
