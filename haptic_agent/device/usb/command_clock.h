// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

#include "haptic_agent/device/haptic_device.h"

namespace kerf::agent {

/// Measures the time from the composition of a command to the arrival of the first report that
/// names it as the last accepted one. Used on the event thread; `echo` from any thread.
class CommandClock {
 public:
  /// A device was connected: earlier commands will not be acknowledged.
  void restart() noexcept { sent_ = {}; }
  void composed(std::uint16_t sequence, std::uint64_t now_us) noexcept {
    sent_[sequence % kKept] = {sequence, now_us};
  }
  /// A report says that this command was the last one accepted. Repetitions are ignored.
  void accepted(std::uint16_t sequence, std::uint64_t now_us) noexcept {
    Sent& sent = sent_[sequence % kKept];
    if (sent.time_us == 0 || sent.sequence != sequence) return;
    const std::uint64_t passed_us = now_us - std::min(now_us, sent.time_us);
    sent.time_us = 0;
    count_.fetch_add(1, std::memory_order_relaxed);
    sum_us_.fetch_add(passed_us, std::memory_order_relaxed);
    if (passed_us > most_us_.load(std::memory_order_relaxed)) {
      most_us_.store(passed_us, std::memory_order_relaxed);
    }
  }

  CommandEcho echo() const noexcept {
    const std::uint64_t count = count_.load(std::memory_order_relaxed);
    return {.count = count,
            .mean_us = count > 0 ? sum_us_.load(std::memory_order_relaxed) / count : 0,
            .most_us = most_us_.load(std::memory_order_relaxed)};
  }

 private:
  /// Commands in flight, at most.
  static constexpr std::size_t kKept = 64;
  struct Sent {
    std::uint16_t sequence = 0;
    std::uint64_t time_us = 0;  ///< 0: none, or acknowledged
  };

  std::array<Sent, kKept> sent_{};
  std::atomic<std::uint64_t> count_{0}, sum_us_{0}, most_us_{0};
};

}  // namespace kerf::agent
