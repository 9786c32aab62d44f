// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "haptic_agent/servo/grip.h"

namespace kerf::agent {

/// Path length over which the heading follows a new direction, mm. A device that renders k N/mm
/// stably can reverse a force F over a length F/k. A shorter one would be a stiffer spring.
inline constexpr double kHeadingMm = 0.5;

/// The grip at one tick.
struct PastGrip {
  std::uint64_t time_us = 0;
  Grip grip{};
  Twist velocity{};
  /// Path length of the tip since the start.
  double path_mm = 0;
  /// See LocalModel::heading.
  Vec3 heading{};
};

/// The grips of the last second, to look up the one that an answer refers to.
class GripHistory {
 public:
  static constexpr std::size_t kKept = 1024;

  /// Times must increase.
  void push(const PastGrip& now) noexcept { kept_[count_++ % kKept] = now; }

  /// Returns the newest grip not after `time_us`, or null if that is too long ago or before the
  /// start. The search begins at the newest grip, because most answers are a few ticks old.
  const PastGrip* at(std::uint64_t time_us) const noexcept {
    const std::size_t kept = std::min(count_, kKept);
    std::size_t high = count_;
    for (std::size_t back = 1; high > count_ - kept; back *= 2) {
      const std::size_t low = count_ - std::min(back, kept);
      if (kept_[low % kKept].time_us <= time_us) return newest_in(low, high, time_us);
      high = low;
    }
    return nullptr;
  }

 private:
  /// Like `at`, for a grip at index `low` or later and before `high`.
  const PastGrip* newest_in(std::size_t low, std::size_t high,
                            std::uint64_t time_us) const noexcept {
    while (high - low > 1) {
      const std::size_t middle = low + (high - low) / 2;
      (kept_[middle % kKept].time_us <= time_us ? low : high) = middle;
    }
    return &kept_[low % kKept];
  }

  std::array<PastGrip, kKept> kept_{};
  std::size_t count_ = 0;
};

}  // namespace kerf::agent
