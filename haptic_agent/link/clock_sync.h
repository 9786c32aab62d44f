// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "haptic_agent/realtime/histogram.h"

namespace kerf::agent {

/// Round-trip times and the offset of the server's clock, from pings and pongs.
class ClockSync {
 public:
  /// Adds a pong. All times in us: local time of sending, the server's time, local time of arrival.
  void take(std::uint64_t sent_us, std::uint64_t server_us, std::uint64_t arrival_us) noexcept {
    if (arrival_us < sent_us) return;
    const std::uint64_t rtt_us = arrival_us - sent_us;
    rtt_us_.add(rtt_us);
    newest_[count_++ % kWindow] = {rtt_us, static_cast<std::int64_t>(server_us) -
                                               static_cast<std::int64_t>(sent_us + rtt_us / 2)};
  }

  /// Returns the server's clock minus the local clock, from the pong with the shortest round trip
  /// of the last 32.
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
