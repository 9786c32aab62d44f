// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

namespace kerf::agent {

/// Histogram of durations in microseconds. Buckets are exact below 16 us and at most 1/16 of their
/// value wide above, up to 2^32 us. One thread writes. Read it after that thread has ended.
class Histogram {
 public:
  void add(std::uint64_t value_us) noexcept {
    ++counts_[bucket(value_us)];
    ++total_;
    max_us_ = std::max(max_us_, value_us);
  }

  std::uint64_t total() const noexcept { return total_; }
  std::uint64_t max_us() const noexcept { return max_us_; }

  /// Returns the upper edge of the bucket below which a share of `part` (0..1) of all values fall,
  /// or 0 if empty.
  std::uint64_t quantile_us(double part) const noexcept {
    const double target = part * static_cast<double>(total_);
    std::uint64_t seen = 0;
    for (std::size_t i = 0; i < counts_.size(); ++i) {
      seen += counts_[i];
      if (seen > 0 && static_cast<double>(seen) >= target) return std::min(upper_us(i), max_us_);
    }
    return max_us_;
  }

 private:
  static constexpr int kSubBits = 4;
  static constexpr std::uint64_t kSub = 1U << kSubBits;
  static constexpr int kMaxBits = 32;
  static constexpr std::size_t kBuckets = (kMaxBits - kSubBits + 1) * kSub;

  /// Values with the same leading five bits share a bucket.
  static std::size_t bucket(std::uint64_t value) noexcept {
    if (value < kSub) return value;
    const int shift = static_cast<int>(std::bit_width(value)) - 1 - kSubBits;
    const std::size_t index = static_cast<std::size_t>(shift) * kSub + (value >> shift);
    return std::min(index, kBuckets - 1);
  }
  static std::uint64_t upper_us(std::size_t index) noexcept {
    if (index < 2 * kSub) return index;
    const std::size_t shift = index / kSub - 1;
    return ((kSub + index % kSub + 1) << shift) - 1;
  }

  std::array<std::uint64_t, kBuckets> counts_{};
  std::uint64_t total_ = 0;
  std::uint64_t max_us_ = 0;
};

}  // namespace kerf::agent
