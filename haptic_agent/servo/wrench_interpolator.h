// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "haptic_agent/servo/server_wrench.h"

namespace kerf::agent {

/// Linear interpolation of Zhu & Lee 2004, section 4: from the previous wrench of the server to the
/// newest, over the time between their arrivals. This avoids steps at the cost of a delay of one
/// such interval.
class WrenchInterpolator {
 public:
  /// Limits of the interpolation time, whatever the time between arrivals.
  static constexpr std::uint64_t kLongestUs = 20'000;
  static constexpr std::uint64_t kShortestUs = 1'000;

  /// Adds a new wrench. Arrival times must not decrease.
  void take(const ServerWrench& next, std::uint64_t now_us) noexcept;
  /// Forgets the wrenches so far: the output is zero until the next one.
  void forget_wrench() noexcept { from_ = newest_.wrench = {}; }
  /// Returns the wrench to output now, or zero before the first.
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
