// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "haptic_agent/device/units.h"

namespace kerf::agent {

/// Token bucket for outgoing samples. After an interruption the backlog is sent slightly faster
/// than it grows instead of at once, which keeps the agent below the server's rate limit.
class Pace {
 public:
  static constexpr double kSamplesPerS = 1225.0;
  static constexpr double kBurst = 900.0;

  /// Returns the number of samples that may be sent at this time. Times must not decrease.
  std::size_t allowed(std::uint64_t now_us) noexcept {
    if (last_us_ != 0) {
      tokens_ += static_cast<double>(now_us - last_us_) * kSPerUs * kSamplesPerS;
      tokens_ = std::min(tokens_, kBurst);
    }
    last_us_ = now_us;
    return static_cast<std::size_t>(tokens_);
  }
  /// Removes `samples` tokens; at most as many as were allowed.
  void sent(std::size_t samples) noexcept { tokens_ -= static_cast<double>(samples); }

 private:
  double tokens_ = kBurst;
  std::uint64_t last_us_ = 0;
};

}  // namespace kerf::agent
