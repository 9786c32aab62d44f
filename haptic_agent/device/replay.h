// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "haptic_agent/device/haptic_device.h"
#include "haptic_agent/device/path_cursor.h"

namespace kerf::agent {

/// Plays a path exactly at its times. It has no motors and ignores wrenches.
class Replay final : public HapticDevice {
 public:
  explicit Replay(PathCursor path);

  DeviceCapabilities capabilities() const override;
  DeviceState read(std::uint64_t now_us) noexcept override;
  void write(const Wrench& wrench) noexcept override;
  void stop() noexcept override {}

 private:
  PathCursor path_;
  bool started_ = false;
  std::uint64_t start_us_ = 0;
};

}  // namespace kerf::agent
