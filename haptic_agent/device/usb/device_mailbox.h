// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>

#include "haptic_agent/device/haptic_device.h"
#include "haptic_agent/realtime/clock.h"
#include "haptic_agent/realtime/latest_value.h"

namespace kerf::agent {

/// Lock-free exchange between a device's event thread and the servo thread: poses in one direction,
/// wrenches in the other. Only the newest value is kept.
class DeviceMailbox {
 public:
  /// A pose older than this is not valid.
  static constexpr std::uint64_t kPoseLifeUs = 20'000;

  /// Event thread: publishes the newest pose.
  void publish(const DeviceState& state) noexcept { states_.write(state); }

  /// Servo thread: returns the newest pose; not valid if it is too old or there is none.
  DeviceState fetch(std::uint64_t now_us) noexcept {
    states_.read(state_);
    DeviceState state = state_;
    state.valid = state.valid && now_us < state.time_us + kPoseLifeUs;
    return state;
  }

  /// Servo thread: sets the wrench to output.
  void write(const Wrench& wrench) noexcept {
    wrenches_.write({.wrench = wrench, .time_us = monotonic_us()});
    stopped_.store(false, std::memory_order_release);
  }
  /// Any thread: sets the force to zero until the next `write`.
  void stop() noexcept { stopped_.store(true, std::memory_order_release); }

  /// Event thread: returns the wrench to output now, or zero if it is too old, stopped or not
  /// finite. `changed` is set if there was a write or stop since the last call.
  Wrench output(std::uint64_t now_us, bool& changed) noexcept {
    // `stopped_` is read before the wrench: a wrench written in between is output by the next call.
    const bool stopped = stopped_.load(std::memory_order_acquire);
    changed = wrenches_.read(newest_) || stopped != was_stopped_;
    was_stopped_ = stopped;
    const bool old = now_us >= newest_.time_us + kWrenchLifeUs;
    const bool finite = is_finite(newest_.wrench.force_n) && is_finite(newest_.wrench.torque_nmm);
    return stopped || old || !finite ? Wrench{} : newest_.wrench;
  }

 private:
  struct TimedWrench {
    Wrench wrench{};
    std::uint64_t time_us = 0;
  };

  LatestValue<DeviceState> states_;
  LatestValue<TimedWrench> wrenches_;
  std::atomic<bool> stopped_{true};
  DeviceState state_;        // servo thread
  TimedWrench newest_;       // event thread
  bool was_stopped_ = true;  // event thread
};

}  // namespace kerf::agent
