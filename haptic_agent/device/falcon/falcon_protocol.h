// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "haptic_agent/device/falcon/falcon_frame.h"
#include "haptic_agent/device/falcon/falcon_kinematics.h"
#include "haptic_agent/device/usb/usb_haptic_device.h"

namespace kerf::agent::falcon {

/// Placement of the Falcon in session coordinates, and its firmware.
struct FalconSettings {
  /// Position of the tool's tip, in session coordinates, at the center of the workspace.
  Vec3 middle_mm{};
  /// If empty, a firmware must be running already.
  std::vector<std::uint8_t> firmware{};
};

/// Novint Falcon: three sensed and three actuated degrees of freedom. The tool's axis is vertical
/// and its tip is at the grip. Torques are ignored.
class FalconProtocol final : public HapticProtocol {
 public:
  static constexpr UsbId kId{0x0403, 0xCB48};

  explicit FalconProtocol(FalconSettings settings);

  std::string_view name() const noexcept override { return "Novint Falcon"; }
  std::vector<UsbId> ids() const override { return {kId}; }
  PipeRequirements required_pipes() const override;
  std::uint64_t silence_limit_us() const noexcept override;
  DeviceCapabilities capabilities() const override;

  std::expected<void, UsbError> identify(UsbSyncIo& io) override;
  void connected(std::uint64_t now_us) noexcept override;
  bool take(std::span<const std::uint8_t> packet, std::uint64_t now_us) noexcept override;
  std::size_t compose(std::span<std::uint8_t> packet, std::uint64_t now_us) noexcept override;
  /// Restarts the answer timeout: on a slow bus the command may have been delayed.
  void sent(std::uint64_t now_us) noexcept override { sent_us_ = now_us; }
  void disable_motors() noexcept override { motors_disabled_ = true; }
  void disconnected() noexcept override;
  DevicePhase phase() const noexcept override;
  std::string_view trouble() const noexcept override;

 private:
  bool homed() const noexcept { return state_ && state_->homed == kAllHomed; }
  std::array<std::int16_t, 3> motors(std::uint64_t now_us) noexcept;

  FalconSettings settings_;
  FrameReader reader_;
  std::optional<FalconState> state_;
  std::optional<Vec3> position_mm_;
  LegTracker legs_;
  LegAngles angles_{};
  std::uint64_t pose_us_ = 0;
  bool waiting_ = false;
  bool motors_disabled_ = false;
  std::uint64_t sent_us_ = 0;
  std::uint64_t answered_us_ = 0;
};

}  // namespace kerf::agent::falcon
