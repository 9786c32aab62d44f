// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace kerf::agent {

/// Time as the servo loop sees it; tests put their own in its place.
class ServoClock {
 public:
  virtual ~ServoClock() = default;
  /// Nanoseconds since some start; never goes back.
  virtual std::uint64_t now_ns() noexcept = 0;
  /// Returns at that time or later.
  virtual void sleep_until_ns(std::uint64_t time_ns) noexcept = 0;
};

/// CLOCK_MONOTONIC, with sleeps to an absolute time, so that lateness does not add up.
class MonotonicClock final : public ServoClock {
 public:
  std::uint64_t now_ns() noexcept override;
  void sleep_until_ns(std::uint64_t time_ns) noexcept override;
};

}  // namespace kerf::agent
