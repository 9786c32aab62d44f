// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bitset>
#include <cstddef>
#include <cstdint>

namespace kerf::datagram {

/// Sliding window of the counters received in one direction. Admits each counter once, and only
/// while it is less than kCounters behind the newest. Older datagrams can be dropped, because newer
/// ones repeat their contents.
class ReplayWindow {
 public:
  static constexpr std::size_t kCounters = 256;

  /// True if a datagram with this counter is acceptable.
  bool admits(std::uint64_t counter) const noexcept {
    if (counter == 0) return false;
    if (counter > newest_) return true;
    const std::uint64_t behind = newest_ - counter;
    return behind < kCounters && !seen_[static_cast<std::size_t>(behind)];
  }

  /// Records an admitted counter; true if it is the newest so far.
  bool take(std::uint64_t counter) noexcept {
    if (counter <= newest_) {
      seen_.set(static_cast<std::size_t>(newest_ - counter));
      return false;
    }
    const std::uint64_t ahead = counter - newest_;
    if (ahead >= kCounters) {
      seen_.reset();
    } else {
      seen_ <<= static_cast<std::size_t>(ahead);
    }
    seen_.set(0);
    newest_ = counter;
    return true;
  }

  std::uint64_t newest() const noexcept { return newest_; }

 private:
  /// Bit i: the counter newest_ - i was received.
  std::bitset<kCounters> seen_;
  std::uint64_t newest_ = 0;
};

}  // namespace kerf::datagram
