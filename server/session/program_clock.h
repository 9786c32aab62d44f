// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <chrono>

#include "server/platform/clock.h"

namespace kerf {

/// The time of a program, s of its cycle time at feed rate. Runs `speed` times as fast as the
/// machine's clock and stops with stop().
class ProgramClock {
 public:
  double now_s(Clock::time_point now) const {
    if (!runs_) return base_s_;
    return base_s_ + std::chrono::duration<double>(now - base_).count() * speed_;
  }
  double speed() const { return speed_; }
  void run(Clock::time_point now) {
    base_s_ = now_s(now);
    base_ = now;
    runs_ = true;
  }
  void stop(Clock::time_point now) {
    base_s_ = now_s(now);
    runs_ = false;
  }
  void set_speed(double speed, Clock::time_point now) {
    base_s_ = now_s(now);
    base_ = now;
    speed_ = speed;
  }
  /// Clamps the time to a range.
  void clamp(double from_s, double to_s, Clock::time_point now) {
    base_s_ = std::clamp(now_s(now), from_s, to_s);
    base_ = now;
  }

 private:
  Clock::time_point base_{};
  double base_s_ = 0, speed_ = 1;
  bool runs_ = false;
};

}  // namespace kerf
