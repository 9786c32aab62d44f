// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <chrono>

namespace kerf {

/// Token bucket: allows `rate_per_s` events per second on average and `burst` at once.
class RateLimit {
 public:
  using Clock = std::chrono::steady_clock;
  RateLimit(double rate_per_s, double burst) : rate_(rate_per_s), burst_(burst), tokens_(burst) {}

  /// Takes one token; false if the bucket is empty.
  bool allow(Clock::time_point now) {
    if (last_ != Clock::time_point{}) {
      const double passed_s = std::chrono::duration<double>(now - last_).count();
      tokens_ = std::min(burst_, tokens_ + passed_s * rate_);
    }
    last_ = now;
    if (tokens_ < 1) return false;
    tokens_ -= 1;
    return true;
  }

 private:
  double rate_, burst_, tokens_;
  Clock::time_point last_{};
};

}  // namespace kerf
