// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "haptic_agent/servo/server_wrench.h"

namespace kerf::agent {

/// Zhu & Lee 2004, section 4: between two wrenches from the server the loop shows the straight line
/// from the one before to the newest, over the time that passed between their arrivals. This costs
/// a delay of one such interval, and in return the hand never feels a step.
class WrenchInterpolator {
 public:
  /// Longest time over which a new wrench is approached, whatever the gap before it.
  static constexpr std::uint64_t kLongestUs = 20'000;
  static constexpr std::uint64_t kShortestUs = 1'000;

  /// A new wrench has come. Arrivals must not go back.
  void take(const ServerWrench& next, std::uint64_t now_us) noexcept;
  /// The wrench to show now; zero before the first.
  Wrench at(std::uint64_t now_us) const noexcept;

  bool has_wrench() const noexcept { return has_; }
  const ServerWrench& newest() const noexcept { return newest_; }

 private:
  Wrench from_;
  ServerWrench newest_;
  std::uint64_t start_us_ = 0;
  std::uint64_t span_us_ = kLongestUs;
  bool has_ = false;
};

}  // namespace kerf::agent
