// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bitset>
#include <cstddef>
#include <cstdint>

namespace kerf::datagram {

/// Which counters of a direction have been seen: each passes once, and only while it is not too far
/// behind the newest. What is farther behind says nothing new: newer datagrams repeat it.
class ReplayWindow {
 public:
  static constexpr std::size_t kCounters = 256;

  /// True if a datagram of this counter may still come.
  bool admits(std::uint64_t counter) const noexcept {
    if (counter == 0) return false;
    if (counter > newest_) return true;
    const std::uint64_t behind = newest_ - counter;
    return behind < kCounters && !seen_[static_cast<std::size_t>(behind)];
  }

  /// Notes one that was admitted; true if it is the newest so far.
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
  /// Bit i: the counter that is i behind the newest.
  std::bitset<kCounters> seen_;
  std::uint64_t newest_ = 0;
};

}  // namespace kerf::datagram
