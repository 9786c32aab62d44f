// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <chrono>
#include <optional>

#include "server/platform/clock.h"

namespace kerf {

/// Token bucket: allows `rate_per_s` events per second on average and `burst` at once.
class RateLimit {
 public:
  RateLimit(double rate_per_s, double burst) : rate_(rate_per_s), burst_(burst), tokens_(burst) {}

  /// Takes one token; false if the bucket is empty.
  bool allow(Clock::time_point now) { return take(now, 0).has_value(); }
  /// Takes one token, possibly a future one, and returns the time until it is available, s. If that
  /// exceeds `wait_max_s`, takes nothing and returns nullopt.
  std::optional<double> take(Clock::time_point now, double wait_max_s) {
    if (last_ != Clock::time_point{}) {
      const double passed_s = std::chrono::duration<double>(now - last_).count();
      tokens_ = std::min(burst_, tokens_ + passed_s * rate_);
    }
    last_ = now;
    const double wait_s = tokens_ < 1 ? (1 - tokens_) / rate_ : 0;
    if (wait_s > wait_max_s) return std::nullopt;
    tokens_ -= 1;
    return wait_s;
  }

 private:
  double rate_, burst_, tokens_;
  Clock::time_point last_{};
};

}  // namespace kerf
