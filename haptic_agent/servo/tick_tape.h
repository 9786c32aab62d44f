// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>

#include "haptic_agent/realtime/spsc_ring.h"
#include "haptic_agent/servo/force_mode.h"
#include "haptic_agent/servo/supervisor.h"

namespace kerf::agent {

/// One recorded tick of the servo, as the hand feels it: in device space, which is the session's
/// unless there is a mapping. Wrenches are about the pivot.
struct TickRecord {
  /// Number of the tick on its tape from 1, counting dropped ones. Set by TickTape::push.
  std::uint64_t number = 0;
  std::uint64_t time_us = 0;        ///< start of the tick, CLOCK_MONOTONIC
  std::uint64_t pose_us = 0;        ///< when the device measured the pose, on the same clock
  std::uint64_t answer_age_us = 0;  ///< age of the newest answer; 0 before the first
  Vec3 tip_mm{};
  Vec3 axis{0, 0, 1};
  /// Computed by the session at this pose, including guides and a followed participant.
  Wrench computed{};
  /// Requested from the output stage, before the supervisor's gain, passivity and limits.
  Wrench requested{};
  /// Written to the device.
  Wrench felt{};
  double energy_mj = 0;   ///< level of the energy tank
  double felt_share = 1;  ///< share of the computed wrench that is felt, 0 to 1
  std::uint32_t buttons = 0;
  std::uint32_t tool_id = 0;
  std::uint32_t lost = 0;  ///< ticks lost since the previous one
  ServoPhase phase = ServoPhase::kReady;
  TripCode trip = TripCode::kNone;  ///< the latest trip; kNone before the first
  ForceMode mode = ForceMode::kModel;
  bool has_pose = false;  ///< false without a usable pose; tip and axis are the last ones
};

/// Passes every tick from the servo thread to one other thread. The servo never waits: a tick that
/// finds the ring full (its reader is 16 s behind) is dropped and counted.
class TickTape {
 public:
  static constexpr std::size_t kTicks = 16'384;

  /// Servo thread.
  void push(TickRecord tick) noexcept {
    tick.number = ++pushed_;
    if (!ring_.push(tick)) lost_.fetch_add(1, std::memory_order_relaxed);
  }
  /// Other thread. Returns false and leaves `tick` unchanged if there is none.
  bool pop(TickRecord& tick) noexcept { return ring_.pop(tick); }

  /// Ticks dropped so far. From any thread.
  std::uint64_t lost() const noexcept { return lost_.load(std::memory_order_relaxed); }

 private:
  SpscRing<TickRecord, kTicks> ring_;
  std::uint64_t pushed_ = 0;  ///< servo thread
  std::atomic<std::uint64_t> lost_{0};
};

}  // namespace kerf::agent
