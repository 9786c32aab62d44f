// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

#include "haptic_agent/servo/supervisor.h"

namespace kerf::agent {

/// State of one tick, as logged after a trip.
struct FlightTick {
  std::uint64_t time_us = 0;
  Vec3 tip_mm{};
  Vec3 velocity_mm_per_s{};  ///< of the pivot
  Wrench requested{};
  Wrench output{};
  double energy_mj = 0;
  std::uint64_t answer_age_us = 0;
  std::uint64_t lost_now = 0;
  ServoPhase phase = ServoPhase::kReady;
};

/// The last ticks before a trip.
struct FlightLog {
  static constexpr std::size_t kTicks = 200;
  TripCode code = TripCode::kNone;
  std::size_t count = 0;
  std::array<FlightTick, kTicks> ticks{};  ///< oldest first
};

/// Keeps the last 200 ms in memory and passes them to another thread at a trip, without waiting. A
/// trip that happens while the previous log is still being read is not logged.
class FlightRecorder {
 public:
  /// Servo thread.
  void note(const FlightTick& tick) noexcept { ring_[count_++ % ring_.size()] = tick; }
  void trip(TripCode code) noexcept {
    if (full_.load(std::memory_order_acquire)) return;
    log_.code = code;
    log_.count = count_ < ring_.size() ? count_ : ring_.size();
    for (std::size_t i = 0; i < log_.count; ++i) {
      log_.ticks[i] = ring_[(count_ - log_.count + i) % ring_.size()];
    }
    full_.store(true, std::memory_order_release);
  }

  /// Other thread: returns the log of a trip, valid until `done`, or null if there is none.
  const FlightLog* log() const noexcept {
    return full_.load(std::memory_order_acquire) ? &log_ : nullptr;
  }
  void done() noexcept { full_.store(false, std::memory_order_release); }

 private:
  std::array<FlightTick, FlightLog::kTicks> ring_{};
  std::size_t count_ = 0;
  FlightLog log_;
  std::atomic<bool> full_{false};
};

}  // namespace kerf::agent
