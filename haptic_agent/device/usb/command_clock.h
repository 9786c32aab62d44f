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
  /// Call when a device was connected: earlier commands will not be acknowledged.
  void restart() noexcept {
    sent_ = {};
    newest_ = 0;
    acknowledges_ = false;
    waiting_us_ = 0;
  }
  void composed(std::uint16_t sequence, std::uint64_t now_us) noexcept {
    sent_[sequence % kKept] = {sequence, now_us};
    newest_ = sequence;
    if (waiting_us_ == 0) waiting_us_ = now_us;
  }
  /// Call when a report names this command as the last accepted one, after all earlier ones.
  /// Repetitions are ignored.
  void accepted(std::uint16_t sequence, std::uint64_t now_us) noexcept {
    Sent& sent = sent_[sequence % kKept];
    if (sent.time_us == 0 || sent.sequence != sequence) return;
    const std::uint64_t passed_us = now_us - std::min(now_us, sent.time_us);
    sent.time_us = 0;
    acknowledges_ = true;
    const auto next = static_cast<std::uint16_t>(sequence == UINT16_MAX ? 1 : sequence + 1);
    const Sent& later = sent_[next % kKept];
    if (sequence == newest_) {
      waiting_us_ = 0;
    } else if (later.sequence == next && later.time_us != 0) {
      waiting_us_ = later.time_us;
    }
    count_.fetch_add(1, std::memory_order_relaxed);
    sum_us_.fetch_add(passed_us, std::memory_order_relaxed);
    if (passed_us > most_us_.load(std::memory_order_relaxed)) {
      most_us_.store(passed_us, std::memory_order_relaxed);
    }
  }

  /// Time of the oldest command not yet accepted, for numbers of 1 to 65535 in turn, or 0 if there
  /// is none or the device has not acknowledged any.
  std::uint64_t waiting_since_us() const noexcept { return acknowledges_ ? waiting_us_ : 0; }

  CommandEcho echo() const noexcept {
    const std::uint64_t count = count_.load(std::memory_order_relaxed);
    return {.count = count,
            .mean_us = count > 0 ? sum_us_.load(std::memory_order_relaxed) / count : 0,
            .most_us = most_us_.load(std::memory_order_relaxed)};
  }

 private:
  /// Greatest number of commands in flight.
  static constexpr std::size_t kKept = 64;
  struct Sent {
    std::uint16_t sequence = 0;
    std::uint64_t time_us = 0;  ///< 0 if unused, or acknowledged
  };

  std::array<Sent, kKept> sent_{};
  std::uint16_t newest_ = 0;
  bool acknowledges_ = false;
  std::uint64_t waiting_us_ = 0;  ///< time of the oldest command in flight; 0 if none
  std::atomic<std::uint64_t> count_{0}, sum_us_{0}, most_us_{0};
};

}  // namespace kerf::agent
