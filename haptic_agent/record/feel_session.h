// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <expected>
#include <string>

#include "haptic_agent/device/device_choice.h"
#include "haptic_agent/record/recording.h"
#include "haptic_agent/servo/servo_cycle.h"

namespace kerf::agent {

/// Replaces the session: answers each sample at once, with no force. The supervisor arms the device
/// as with a server.
class NoSession final : public SampleListener {
 public:
  /// Both arguments must outlive the object.
  NoSession(SampleRing& samples, LatestValue<ServerWrench>& wrenches) noexcept
      : samples_(samples), wrenches_(wrenches) {}

  void sample_ready() noexcept override {
    wire::MotionSample sample;
    while (samples_.pop(sample)) {
      wrenches_.write({.pose_us = sample.time_us, .arrival_us = sample.time_us});
    }
  }

 private:
  SampleRing& samples_;
  LatestValue<ServerWrench>& wrenches_;
};

/// Returns the placement of the device in the recorded session. The error is one sentence without
/// its full stop: recordings of other software may lack stock_min_mm, stock_max_mm or pivot_mm.
std::expected<DevicePlace, std::string> place_of(const Recording& recording);

}  // namespace kerf::agent
