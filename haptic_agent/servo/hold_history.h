// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "haptic_agent/servo/twist.h"

namespace kerf::agent {

/// Where the hand was at one tick.
struct PastHold {
  std::uint64_t time_us = 0;
  Hold hold{};
  Twist velocity{};
  /// Of the tip, since the start.
  double way_mm = 0;
  /// As LocalModel::heading.
  Vec3 heading{};
};

/// The last second of the hand, to find what an answer answers.
class HoldHistory {
 public:
  static constexpr std::size_t kKept = 1024;

  /// Times must grow.
  void push(const PastHold& now) noexcept { kept_[count_++ % kKept] = now; }

  /// The newest hold not after `time_us`; null if that is too long ago or before the start.
  const PastHold* at(std::uint64_t time_us) const noexcept {
    std::size_t low = count_ > kKept ? count_ - kKept : 0;
    std::size_t high = count_;
    if (low == high || kept_[low % kKept].time_us > time_us) return nullptr;
    while (high - low > 1) {
      const std::size_t middle = low + (high - low) / 2;
      (kept_[middle % kKept].time_us <= time_us ? low : high) = middle;
    }
    return &kept_[low % kKept];
  }

 private:
  std::array<PastHold, kKept> kept_{};
  std::size_t count_ = 0;
};

}  // namespace kerf::agent
