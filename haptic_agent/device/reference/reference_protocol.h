// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "haptic_agent/device/reference/report.h"
#include "haptic_agent/device/usb/command_clock.h"
#include "haptic_agent/device/usb/usb_haptic_device.h"

namespace kerf::agent::reference {

/// Placement of the device in session coordinates.
struct PenPlace {
  /// Point in session coordinates at the center of the device's workspace.
  Vec3 middle_mm{};
  /// Distance from the tool's tip along its axis to the pivot, where the user holds it.
  double pivot_mm = 60;
};

/// The ratings that README.md requires of every device.
DeviceCapabilities pen_capabilities(const PenPlace& place);

/// Protocol of the 5-DOF reference device: joint angles in, torques out.
class ReferenceProtocol final : public HapticProtocol {
 public:
  /// `id`: the USB ids, for builders with their own pair.
  explicit ReferenceProtocol(const PenPlace& place, UsbId id = {kVendorId, kProductId}) noexcept;

  std::string_view name() const noexcept override { return "5-DOF reference device"; }
  std::vector<UsbId> ids() const override { return {id_}; }
  PipeRequirements required_pipes() const override;
  std::uint64_t silence_limit_us() const noexcept override;
  DeviceCapabilities capabilities() const override { return pen_capabilities(place_); }
  CommandEcho command_echo() const noexcept override { return command_clock_.echo(); }

  std::expected<void, UsbError> identify(UsbSyncIo& io) override;
  void connected(std::uint64_t now_us) noexcept override;
  bool take(std::span<const std::uint8_t> packet, std::uint64_t now_us) noexcept override;
  std::size_t compose(std::span<std::uint8_t> packet, std::uint64_t now_us) noexcept override;
  void disable_motors() noexcept override { motors_disabled_ = true; }
  void disconnected() noexcept override;
  DevicePhase phase() const noexcept override;
  std::string_view trouble() const noexcept override;

 private:
  bool is_new(std::uint16_t sequence, std::uint64_t now_us) const noexcept;
  bool is_plausible(const PenPose& pose, std::uint64_t now_us, std::uint64_t gap_us) noexcept;
  CommandReport command(std::uint64_t now_us) noexcept;

  PenPlace place_;
  UsbId id_;
  Identity identity_;
  std::optional<StateReport> report_;
  std::uint64_t report_us_ = 0;
  JointTracker joints_;
  std::optional<PenPose> pose_;
  std::uint64_t pose_us_ = 0;
  bool mismatched_ = false;
  bool motors_disabled_ = false;
  std::uint16_t sequence_ = 0;
  std::uint64_t sent_us_ = 0;
  CommandClock command_clock_;
};

}  // namespace kerf::agent::reference
