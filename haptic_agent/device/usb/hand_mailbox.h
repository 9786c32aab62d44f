// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>

#include "haptic_agent/device/haptic_device.h"
#include "haptic_agent/device/usb/monotonic.h"
#include "haptic_agent/servo/latest_value.h"

namespace kerf::agent {

/// A device's pose on its way to the servo thread, and the servo's wrench on its way back: in both
/// directions the newest value only, and nobody waits.
class HandMailbox {
 public:
  /// A pose older than this is none: the hand has moved on.
  static constexpr std::uint64_t kPoseLifeUs = 20'000;

  /// Event thread: the newest pose.
  void publish(const DeviceState& state) noexcept { states_.write(state); }

  /// Servo thread: the newest pose; not valid if it is too old or was never there.
  DeviceState fetch(std::uint64_t now_us) noexcept {
    states_.read(state_);
    DeviceState state = state_;
    state.valid = state.valid && now_us < state.time_us + kPoseLifeUs;
    return state;
  }

  /// Servo thread.
  void show(const Wrench& wrench) noexcept {
    wrenches_.write({.wrench = wrench, .time_us = monotonic_us()});
    stopped_.store(false, std::memory_order_release);
  }
  /// Any thread: no force until the next `show`.
  void stop() noexcept { stopped_.store(true, std::memory_order_release); }

  /// Event thread: what the motors should show now. `fresh`: it was not asked for before.
  Wrench wanted(std::uint64_t now_us, bool& fresh) noexcept {
    // Read first: a wrench that is written meanwhile is then taken at the next call.
    const bool stopped = stopped_.load(std::memory_order_acquire);
    fresh = wrenches_.read(shown_) || stopped != was_stopped_;
    was_stopped_ = stopped;
    const bool old = now_us >= shown_.time_us + kWrenchLifeUs;
    const bool finite = is_finite(shown_.wrench.force_n) && is_finite(shown_.wrench.torque_nmm);
    return stopped || old || !finite ? Wrench{} : shown_.wrench;
  }

 private:
  struct Shown {
    Wrench wrench{};
    std::uint64_t time_us = 0;
  };

  LatestValue<DeviceState> states_;
  LatestValue<Shown> wrenches_;
  std::atomic<bool> stopped_{true};
  DeviceState state_;        // the servo's
  Shown shown_;              // the event thread's
  bool was_stopped_ = true;  // likewise
};

}  // namespace kerf::agent
