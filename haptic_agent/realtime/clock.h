// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <ctime>

namespace kerf::agent {

/// Time and sleep of a periodic loop; tests substitute a simulated clock.
class Clock {
 public:
  virtual ~Clock() = default;
  /// Nanoseconds since an arbitrary start; never decreases.
  virtual std::uint64_t now_ns() noexcept = 0;
  /// Returns at `time_ns` or later.
  virtual void sleep_until_ns(std::uint64_t time_ns) noexcept = 0;
};

/// CLOCK_MONOTONIC. Sleeps to absolute times, so that lateness does not accumulate.
class MonotonicClock final : public Clock {
 public:
  std::uint64_t now_ns() noexcept override;
  void sleep_until_ns(std::uint64_t time_ns) noexcept override;
};

inline constexpr std::uint64_t kNsPerS = 1'000'000'000;

/// Converts a time in nanoseconds to a timespec.
inline timespec timespec_of(std::uint64_t time_ns) noexcept {
  return {.tv_sec = static_cast<time_t>(time_ns / kNsPerS),
          .tv_nsec = static_cast<long>(time_ns % kNsPerS)};
}

/// Returns CLOCK_MONOTONIC in nanoseconds: the same value on every thread. Does not wait or
/// allocate.
inline std::uint64_t monotonic_ns() noexcept {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return static_cast<std::uint64_t>(now.tv_sec) * kNsPerS + static_cast<std::uint64_t>(now.tv_nsec);
}

/// Like monotonic_ns, in microseconds.
inline std::uint64_t monotonic_us() noexcept { return monotonic_ns() / 1000; }

}  // namespace kerf::agent
