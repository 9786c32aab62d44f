// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "haptic_agent/servo/histogram.h"

namespace kerf::agent {

/// Round-trip times and the server's clock, from pings and their answers.
class ClockSync {
 public:
  /// All in us: our time at sending, the server's time, our time at arrival.
  void take(std::uint64_t sent_us, std::uint64_t server_us, std::uint64_t arrival_us) noexcept {
    if (arrival_us < sent_us) return;
    const std::uint64_t rtt_us = arrival_us - sent_us;
    rtt_us_.add(rtt_us);
    newest_[count_++ % kWindow] = {rtt_us, static_cast<std::int64_t>(server_us) -
                                               static_cast<std::int64_t>(sent_us + rtt_us / 2)};
  }

  /// What to add to our clock to get the server's: of the last answers, the quickest one knows
  /// best.
  std::int64_t offset_us() const noexcept {
    Answer best;
    for (std::size_t i = 0; i < kWindow && i < count_; ++i) {
      if (i == 0 || newest_[i].rtt_us < best.rtt_us) best = newest_[i];
    }
    return best.offset_us;
  }

  const Histogram& rtt_us() const noexcept { return rtt_us_; }

 private:
  static constexpr std::size_t kWindow = 32;
  struct Answer {
    std::uint64_t rtt_us = 0;
    std::int64_t offset_us = 0;
  };

  std::array<Answer, kWindow> newest_{};
  std::size_t count_ = 0;
  Histogram rtt_us_;
};

}  // namespace kerf::agent
