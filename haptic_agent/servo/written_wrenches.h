// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "haptic_agent/servo/grip.h"

namespace kerf::agent {

/// The wrenches written last. A device outputs a written wrench after an unknown latency up to a
/// known maximum, until the next one acts, so several may be the acting one.
class WrittenWrenches {
 public:
  /// Number of wrenches that are kept; before the first write, the output is zero.
  static constexpr std::size_t kKept = 32;

  /// `now_us` must not decrease from call to call.
  void write(const Wrench& wrench, std::uint64_t now_us) noexcept {
    newest_ = (newest_ + 1) % kKept;
    kept_[newest_] = {now_us, wrench};
  }

  /// Calls `visit(wrench, until_us)`, newest first, for each wrench that may act after `from_us`,
  /// for any latency up to `latency_us`. `until_us`: the time at which its successor certainly
  /// acts; for the newest wrench, as if a successor were written at `now_us`.
  template <typename Visit>
  void for_each_possible(std::uint64_t from_us, std::uint64_t now_us, std::uint64_t latency_us,
                         const Visit& visit) const noexcept {
    std::uint64_t until_us = now_us + latency_us;
    for (std::size_t age = 0; age < kKept; ++age) {
      const Entry& entry = kept_[(newest_ + kKept - age) % kKept];
      visit(entry.wrench, until_us);
      until_us = entry.time_us + latency_us;
      if (until_us <= from_us) return;
    }
  }

  /// Returns the greatest work of any wrench that may have acted since `from_us`, mJ, for the
  /// displacement `moved` since then. If the wrenches acted one after the other, the work along the
  /// straight path is a weighted mean of theirs and not greater.
  double greatest_work(const Twist& moved, std::uint64_t from_us, std::uint64_t now_us,
                       std::uint64_t latency_us) const noexcept {
    double greatest = -std::numeric_limits<double>::infinity();
    for_each_possible(from_us, now_us, latency_us, [&](const Wrench& wrench, std::uint64_t) {
      greatest = std::max(greatest, work(wrench, moved));
    });
    return greatest;
  }

 private:
  struct Entry {
    std::uint64_t time_us = 0;
    Wrench wrench{};
  };
  std::array<Entry, kKept> kept_{};
  std::size_t newest_ = 0;
};

}  // namespace kerf::agent
