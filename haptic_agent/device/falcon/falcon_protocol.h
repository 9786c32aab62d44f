// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "haptic_agent/device/falcon/falcon_frame.h"
#include "haptic_agent/device/falcon/falcon_kinematics.h"
#include "haptic_agent/device/usb/usb_hand.h"

namespace kerf::agent::falcon {

/// Where the Falcon's coordinates lie in the session's, and which firmware it is given.
struct FalconSettings {
  /// The session's point at the middle of the grip's workspace, as the tool's tip sees it.
  Vec3 middle_mm{};
  /// Empty: it must run one already.
  std::vector<std::uint8_t> firmware{};
};

/// Novint Falcon: three degrees of freedom, felt and shown. The tool stands upright and the grip is
/// its tip; a torque cannot be shown and is left out.
class FalconProtocol final : public HandProtocol {
 public:
  static constexpr UsbId kId{0x0403, 0xCB48};

  explicit FalconProtocol(FalconSettings settings);

  std::string_view name() const noexcept override { return "Novint Falcon"; }
  std::vector<UsbId> ids() const override { return {kId}; }
  PipeWish pipes() const override;
  std::uint64_t silence_limit_us() const noexcept override;
  DeviceCapabilities capabilities() const override;

  std::expected<void, UsbError> identify(UsbTalk& talk) override;
  void connected(std::uint64_t now_us) noexcept override;
  bool take(std::span<const std::uint8_t> packet, std::uint64_t now_us) noexcept override;
  std::size_t compose(std::span<std::uint8_t> packet, std::uint64_t now_us) noexcept override;
  /// The answer can only begin now: on a slow bus the command may have waited for long.
  void sent(std::uint64_t now_us) noexcept override { sent_us_ = now_us; }
  void silence() noexcept override { silent_ = true; }
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
  LegAngles angles_{};
  std::uint64_t pose_us_ = 0;
  bool waiting_ = false;
  bool silent_ = false;
  std::uint64_t sent_us_ = 0;
  std::uint64_t answered_us_ = 0;
};

}  // namespace kerf::agent::falcon
